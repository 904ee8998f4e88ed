// JSON that came from outside: looked into with care, and taken for what it is.

/** A member of what may be an object. */
export const member = (of: unknown, name: string): unknown =>
  typeof of === "object" && of !== null ? (of as Record<string, unknown>)[name] : undefined;

export const items = (of: unknown): readonly unknown[] => (Array.isArray(of) ? (of as unknown[]) : []);

export const entries = (of: unknown): [string, unknown][] => (typeof of === "object" && of !== null ? Object.entries(of) : []);

export const text = (of: unknown): string | undefined => (typeof of === "string" ? of : undefined);

export const finite = (of: unknown): number | undefined => (typeof of === "number" && Number.isFinite(of) ? of : undefined);
