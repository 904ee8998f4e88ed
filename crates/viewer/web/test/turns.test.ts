import { expect, test } from "vitest";

import { Turns } from "../src/page/turns";

test("of many wishes while one is being met only the last is met", async () => {
  const turns = new Turns();
  const met: number[] = [];
  let wished = 0;
  const meet = async (): Promise<boolean> => {
    const one = wished;
    await new Promise((resolve) => setTimeout(resolve, 5));
    met.push(one);
    return true;
  };
  const first = turns.take("plane", meet);
  for (wished = 1; wished < 40; wished++) void turns.take("plane", meet);
  wished = 40;
  const other = turns.take("another", meet);
  await Promise.all([first, other]);
  expect(met).toEqual([0, 40, 40]);
});

test("what came too late is asked for again, and what failed is not in the way of the next", async () => {
  const turns = new Turns();
  let asked = 0;
  await turns.take("plane", () => Promise.resolve(++asked === 3));
  expect(asked).toBe(3);
  await expect(turns.take("plane", () => Promise.reject(new Error("no")))).rejects.toThrow("no");
  await turns.take("plane", () => Promise.resolve(++asked === 4));
  expect(asked).toBe(4);
});
