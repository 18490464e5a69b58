// Runs functions of the page's modules outside of a browser: a line of JSON in, a line of JSON out.
// {"script": "async (value) => …", "value": …} gives {"value": …} or {"error": …}. `import` takes paths as the page does.
import { createInterface } from 'node:readline';

const folder = process.argv[2];
const load = (path) => import(new URL(`.${path}`, folder));

/** JSON has no NaN and no infinities, and loses what is undefined. */
const packed = (_, value) =>
  value === undefined ? null : typeof value === 'number' && !Number.isFinite(value) ? { $number: String(value) } : value;
const unpacked = (_, value) => (typeof value?.$number === 'string' ? Number(value.$number) : value);

for await (const line of createInterface({ input: process.stdin })) {
  const { script, value } = JSON.parse(line, unpacked);
  let answer;
  try {
    const made = new Function('load', `return (${script.replaceAll('import(', 'load(')})`)(load);
    answer = { value: await (typeof made === 'function' ? made(value) : made) };
  } catch (error) {
    answer = { error: String(error?.stack ?? error) };
  }
  console.log(JSON.stringify(answer, packed));
}
