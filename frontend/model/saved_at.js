// @ts-check
// When a backup was saved.

/** As its name tells in UTC: 2026-11-25T10-48-03.123456Z.
 * @param {string} name */
export function savedAtText(name) {
  const [day, time = ''] = name.split('T');
  return `${day} ${time.slice(0, 8).replaceAll('-', ':')} UTC`;
}

const NAME = /\d{4}-\d\d-\d\dT\d\d-\d\d-\d\d\.\d{6}Z/g;

/** A message that names backups, with when they were saved instead, as lists of backups have it.
 * @param {string} message */
export function withSavedAt(message) {
  return message.replace(NAME, savedAtText);
}
