/** Finds unused names and ids. */

/** The name itself, or the first unused one of `name_0`, `name_1`, … */
export function freshName(name: string, taken: Iterable<string>): string {
  const names = new Set(taken);
  return names.has(name) ? numberedName(name, names) : name;
}

/** The first unused name of `base_0`, `base_1`, … */
export function numberedName(base: string, taken: Iterable<string>): string {
  const names = new Set(taken);
  let number = 0;
  while (names.has(`${base}_${number}`)) number++;
  return `${base}_${number}`;
}

/** An unused id of six capital letters. */
export function freshId(taken: (id: string) => boolean): string {
  for (;;) {
    const letters = crypto.getRandomValues(new Uint32Array(6));
    const id = Array.from(letters, (number) => String.fromCharCode(65 + (number % 26))).join("");
    if (!taken(id)) return id;
  }
}

/** Smallest unused id from `from` on. */
export function freshNumber(taken: Iterable<{ readonly id: number }>, from = 0): number {
  const ids = new Set<number>();
  for (const { id } of taken) ids.add(id);
  let number = from;
  while (ids.has(number)) number++;
  return number;
}
