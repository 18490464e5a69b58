// @ts-check
// A field that JSON gives more than once: JSON.parse takes the last of its values, and which one is meant nobody knows.

const TOKEN = /("(?:[^"\\]+|\\.)*")(\s*:)?|[[\]{},]/g;

/** The path of the first such field, null: each is given once.
 * @param {string} json that can be parsed @returns {string | null} */
export function repeatedField(json) {
  /** Where it is in the objects and lists that are open, and the names that the objects have so far.
   * @type {{at: string | number, names: Set<string>}[]} */
  const open = [];
  for (const [token, text, colon] of json.matchAll(TOKEN)) {
    const inner = open[open.length - 1];
    if (token === '{') open.push({ at: '', names: new Set() });
    else if (token === '[') open.push({ at: 0, names: new Set() });
    else if (token === '}' || token === ']') open.pop();
    else if (token === ',' && typeof inner.at === 'number') inner.at += 1;
    else if (colon !== undefined) {
      inner.at = String(JSON.parse(text));
      if (inner.names.has(inner.at)) return open.map(({ at }) => at).join('.');
      inner.names.add(inner.at);
    }
  }
  return null;
}
