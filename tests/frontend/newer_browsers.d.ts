/* What the browsers have that Debian's TypeScript (4.8) does not know yet. */
interface Array<T> {
  findLast(found: (value: T, index: number) => unknown): T | undefined;
  findLastIndex(found: (value: T, index: number) => unknown): number;
  toSorted(compare?: (one: T, other: T) => number): T[];
  toSpliced(start: number, deleted?: number, ...inserted: T[]): T[];
  with(index: number, value: T): T[];
}
declare class CompressionStream extends TransformStream<BufferSource, Uint8Array> {
  constructor(format: 'deflate-raw');
}
declare class DecompressionStream extends TransformStream<BufferSource, Uint8Array> {
  constructor(format: 'deflate-raw');
}
