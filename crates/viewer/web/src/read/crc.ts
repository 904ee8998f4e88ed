// CRC-32 as MCAP and zlib have it, eight bytes at a step: a data section of hundreds of megabytes is summed while it
// is read.

const POLYNOMIAL = 0xedb88320;
const SLICES = 8;

/** Table k holds the CRC of each byte followed by k zero bytes. */
const TABLES: Uint32Array[] = [];
for (let slice = 0; slice < SLICES; slice++) {
  const table = new Uint32Array(256);
  for (let byte = 0; byte < 256; byte++) {
    if (slice > 0) {
      const before = TABLES[slice - 1]?.[byte] ?? 0;
      table[byte] = (TABLES[0]?.[before & 0xff] ?? 0) ^ (before >>> 8);
      continue;
    }
    let crc = byte;
    for (let bit = 0; bit < 8; bit++) crc = crc & 1 ? (crc >>> 1) ^ POLYNOMIAL : crc >>> 1;
    table[byte] = crc;
  }
  TABLES.push(table);
}
const [T0, T1, T2, T3, T4, T5, T6, T7] = TABLES as [Uint32Array, Uint32Array, Uint32Array, Uint32Array, Uint32Array, Uint32Array, Uint32Array, Uint32Array];

/** A CRC being summed. */
export class Crc32 {
  private state = 0xffffffff;

  add(bytes: Uint8Array): void {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    let crc = this.state;
    let at = 0;
    for (; at + SLICES <= bytes.length; at += SLICES) {
      const low = crc ^ view.getInt32(at, true);
      const high = view.getInt32(at + 4, true);
      crc =
        (T7[low & 0xff] as number) ^ (T6[(low >>> 8) & 0xff] as number) ^ (T5[(low >>> 16) & 0xff] as number) ^ (T4[low >>> 24] as number) ^
        (T3[high & 0xff] as number) ^ (T2[(high >>> 8) & 0xff] as number) ^ (T1[(high >>> 16) & 0xff] as number) ^ (T0[high >>> 24] as number);
    }
    for (; at < bytes.length; at++) crc = (T0[(crc ^ (bytes[at] as number)) & 0xff] as number) ^ (crc >>> 8);
    this.state = crc;
  }

  get value(): number {
    return ~this.state >>> 0;
  }
}
