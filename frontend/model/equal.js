// @ts-check
// Whether two documents say the same. What one was made from and left alone is shared with it, and not looked into.

/** @param {unknown} one @param {unknown} other @returns {boolean} */
export function areEqual(one, other) {
  if (Object.is(one, other)) return true;
  if (typeof one !== 'object' || typeof other !== 'object' || one === null || other === null) return false;
  if (Array.isArray(one) !== Array.isArray(other)) return false;
  const names = Object.keys(one);
  if (names.length !== Object.keys(other).length) return false;
  return names.every((name) => name in other && areEqual(Reflect.get(one, name), Reflect.get(other, name)));
}
