// Runs functions of the page's modules outside of a browser: a line of JSON in, a line of JSON out.
// {"script": "async (value) => …", "value": …} gives {"value": …} or {"error": …}. `import` takes paths as the page does.
import { createInterface } from 'node:readline';

const folder = process.argv[2];
const load = (path) => import(new URL(`.${path}`, folder));

/** JSON has no NaN and no infinities, and loses what is undefined. */
const packed = (_, value) =>
  value === undefined ? null : typeof value === 'number' && !Number.isFinite(value) ? { $number: String(value) } : value;
const unpacked = (_, value) => (typeof value?.$number === 'string' ? Number(value.$number) : value);

// What a module leaves undone may fail after its answer: told with the next one, as nothing else would say what it was.
const late = [];
for (const event of ['uncaughtException', 'unhandledRejection']) {
  process.on(event, (error) => late.push(`after an earlier answer: ${error?.stack ?? error}`));
}

for await (const line of createInterface({ input: process.stdin })) {
  const { script, value } = JSON.parse(line, unpacked);
  let answer;
  try {
    const made = new Function('load', `return (${script.replaceAll('import(', 'load(')})`)(load);
    answer = { value: await (typeof made === 'function' ? made(value) : made) };
  } catch (error) {
    answer = { error: String(error?.stack ?? error) };
  }
  if (late.length > 0) answer = { error: late.splice(0).join('\n') };
  console.log(JSON.stringify(answer, packed));
}
