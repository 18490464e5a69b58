// @ts-check
// When a backup was saved.

/** As its name tells in UTC: 2026-11-25T10-48-03.123456Z.
 * @param {string} name */
export function savedAtText(name) {
  const [day, time = ''] = name.split('T');
  return `${day} ${time.slice(0, 8).replaceAll('-', ':')} UTC`;
}
