// Two numbers beside each other: in as many digits as tell them apart, with the difference.

/** How a number is written, with more digits than usual if asked. */
export type Writer = (value: number, more?: number) => string;

/** Beyond these, doubles have nothing to tell. */
const MOST = 12;

/** Both in words that differ if they do. */
export const apart = (a: number, b: number, write: Writer): [string, string] => {
  for (let more = 0; more <= MOST; more++) {
    const [one, other] = [write(a, more), write(b, more)];
    if (a === b || one !== other) return [one, other];
  }
  return [String(a), String(b)];
};

/** `+0.150`: by how much the first is more than the second; `equal` if it is not. */
export const excess = (a: number, b: number, write: Writer): string => {
  if (a === b) return "equal";
  const size = Math.abs(a - b);
  const nothing = write(0);
  for (let more = 0; more <= MOST; more++) {
    const words = write(size, more);
    if (words !== nothing && !/^[0.]+\D*$/.test(words)) return `${a > b ? "+" : "−"}${words}`;
  }
  return `${a > b ? "+" : "−"}${size.toExponential(1)}`;
};
