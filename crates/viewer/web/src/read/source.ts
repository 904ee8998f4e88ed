// Where the bytes of a log come from: a file, memory, or the server that served this page.

export interface Source {
  readonly name: string;
  size(): Promise<bigint>;
  read(offset: bigint, length: bigint): Promise<Uint8Array>;
}

export class BlobSource implements Source {
  constructor(
    readonly name: string,
    private readonly blob: Blob,
  ) {}

  async size(): Promise<bigint> {
    return BigInt(this.blob.size);
  }

  async read(offset: bigint, length: bigint): Promise<Uint8Array> {
    const end = Number(offset + length);
    if (end > this.blob.size) throw new RangeError(`byte ${end} is past the end of the file at ${this.blob.size}`);
    return new Uint8Array(await this.blob.slice(Number(offset), end).arrayBuffer());
  }
}

/** A file that a server hands out by ranges; if it knows no ranges, whole. */
export class RangeSource implements Source {
  private whole: Promise<Uint8Array> | undefined;
  private bytes: Promise<bigint> | undefined;

  constructor(
    readonly name: string,
    private readonly url: string,
  ) {}

  size(): Promise<bigint> {
    this.bytes ??= this.measure();
    return this.bytes;
  }

  async read(offset: bigint, length: bigint): Promise<Uint8Array> {
    const size = await this.size();
    if (offset + length > size) throw new RangeError(`byte ${offset + length} is past the end of the file at ${size}`);
    if (length === 0n) return new Uint8Array();
    if (this.whole) return (await this.whole).subarray(Number(offset), Number(offset + length));
    const range = `bytes=${offset}-${offset + length - 1n}`;
    const answer = await fetch(this.url, { headers: { Range: range } });
    if (answer.status !== 206) throw new Error(`${this.url}: status ${answer.status} for ${range}`);
    return new Uint8Array(await answer.arrayBuffer());
  }

  private async measure(): Promise<bigint> {
    const answer = await fetch(this.url, { headers: { Range: "bytes=0-0" } });
    if (!answer.ok) throw new Error(`${this.url}: status ${answer.status}`);
    const total = answer.headers.get("Content-Range")?.split("/")[1];
    if (answer.status === 206 && total !== undefined && /^\d+$/.test(total)) {
      await answer.arrayBuffer();
      return BigInt(total);
    }
    const whole = new Uint8Array(await answer.arrayBuffer());
    this.whole = Promise.resolve(whole);
    return BigInt(whole.byteLength);
  }
}
