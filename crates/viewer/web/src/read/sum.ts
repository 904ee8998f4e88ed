// The CRC of a file's data section, summed along with the reading.

import { Crc32 } from "./crc";
import type { Source } from "./source";

/** Read at once where nothing else reads. */
const STEP_BYTES = 1n << 22n;

export class DataSum {
  private readonly crc = new Crc32();
  /** All bytes before this one are summed. */
  private upTo = 0n;

  constructor(private readonly source: Source) {}

  /** Takes bytes that were read at an offset; those between them and the last are fetched. */
  async take(offset: bigint, bytes: Uint8Array): Promise<void> {
    await this.reach(offset);
    const known = Number(this.upTo - offset);
    if (known >= bytes.length) return;
    this.crc.add(bytes.subarray(known));
    this.upTo = offset + BigInt(bytes.length);
  }

  /** The CRC of all bytes before this one. */
  async value(end: bigint): Promise<number> {
    await this.reach(end);
    return this.crc.value;
  }

  private async reach(offset: bigint): Promise<void> {
    while (this.upTo < offset) {
      const length = offset - this.upTo < STEP_BYTES ? offset - this.upTo : STEP_BYTES;
      this.crc.add(await this.source.read(this.upTo, length));
      this.upTo += length;
    }
  }
}
