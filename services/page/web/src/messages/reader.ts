// Reads LCM's encoding: big-endian, counts before arrays, strings with their length and a zero behind.

/** Why bytes are not the message that they should be. */
export class Refused extends Error {}

const kMaxElements = 1_000_000;
const texts = new TextDecoder();

export class Reader {
  private offset = 0;
  private readonly view: DataView;

  private constructor(private readonly data: Uint8Array) {
    this.view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  }

  /** Decodes one message that uses all of the bytes. */
  static whole<T>(bytes: Uint8Array, fingerprint: string, decode: (reader: Reader) => T): T {
    const reader = new Reader(bytes);
    reader.need(8);
    const hex = (word: number) => word.toString(16).padStart(8, "0");
    const found = hex(reader.view.getUint32(0)) + hex(reader.view.getUint32(4));
    if (found !== fingerprint) throw new Refused(`fingerprint ${found} in place of ${fingerprint}`);
    reader.offset = 8;
    const message = decode(reader);
    if (reader.offset !== bytes.byteLength) throw new Refused(`${bytes.byteLength - reader.offset} bytes behind the message`);
    return message;
  }

  private need(numBytes: number): void {
    if (this.offset + numBytes > this.data.byteLength) throw new Refused("cut short");
  }
  private take(count: number, width: number): number {
    if (!(count >= 0 && count <= kMaxElements)) throw new Refused(`a count of ${count}`);
    this.need(count * width);
    const start = this.offset;
    this.offset += count * width;
    return start;
  }

  byte(): number { return this.view.getUint8(this.take(1, 1)); }
  boolean(): boolean { return this.byte() !== 0; }
  int8(): number { return this.view.getInt8(this.take(1, 1)); }
  int16(): number { return this.view.getInt16(this.take(1, 2)); }
  int32(): number { return this.view.getInt32(this.take(1, 4)); }
  /** A number that JavaScript holds exactly. */
  int64(): number { return this.wide(this.take(1, 8)); }
  float(): number { return this.view.getFloat32(this.take(1, 4)); }
  double(): number { return this.view.getFloat64(this.take(1, 8)); }
  string(): string {
    const length = this.int32();
    const start = this.take(length, 1);
    if (length < 1 || this.data[this.offset - 1] !== 0) throw new Refused("a string without its end");
    return texts.decode(this.data.subarray(start, start + length - 1));
  }

  bytes(count: number): Uint8Array {
    const start = this.take(count, 1);
    return this.data.slice(start, start + count);
  }
  booleans(count: number): boolean[] { return this.array(count, () => this.boolean()); }
  int8s(count: number): Int8Array { return new Int8Array(this.bytes(count)); }
  int16s(count: number): Int16Array { return this.numbers(new Int16Array(this.checked(count, 2)), 2, (at) => this.view.getInt16(at)); }
  int32s(count: number): Int32Array { return this.numbers(new Int32Array(this.checked(count, 4)), 4, (at) => this.view.getInt32(at)); }
  int64s(count: number): Float64Array { return this.numbers(new Float64Array(this.checked(count, 8)), 8, (at) => this.wide(at)); }
  floats(count: number): Float32Array { return this.numbers(new Float32Array(this.checked(count, 4)), 4, (at) => this.view.getFloat32(at)); }
  doubles(count: number): Float64Array { return this.numbers(new Float64Array(this.checked(count, 8)), 8, (at) => this.view.getFloat64(at)); }
  strings(count: number): string[] { return this.array(count, () => this.string()); }

  /** Elements of at least one byte each, so that a count that the bytes cannot hold ends soon. */
  array<T>(count: number, one: () => T): T[] {
    if (!(count >= 0 && count <= kMaxElements)) throw new Refused(`a count of ${count}`);
    const elements: T[] = [];
    for (let i = 0; i < count; ++i) elements.push(one());
    return elements;
  }

  private checked(count: number, width: number): number {
    if (!(count >= 0 && count <= kMaxElements)) throw new Refused(`a count of ${count}`);
    this.need(count * width);
    return count;
  }
  private numbers<T extends Int16Array | Int32Array | Float32Array | Float64Array>(array: T, width: number, read: (at: number) => number): T {
    const start = this.take(array.length, width);
    for (let i = 0; i < array.length; ++i) array[i] = read(start + i * width);
    return array;
  }
  private wide(at: number): number {
    const value = this.view.getInt32(at) * 4294967296 + this.view.getUint32(at + 4);
    if (!Number.isSafeInteger(value)) throw new Refused("an integer beyond 2^53");
    return value;
  }
}
