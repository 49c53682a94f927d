/** Compares a plan with the previous one: kept, added and removed steps, in one order. */

interface Step {
  readonly action: string;
  readonly objects: readonly string[];
}

export interface ComparedStep<T extends Step> {
  readonly step: T;
  readonly difference: "kept" | "added" | "removed";
  /** Index in its own plan. */
  readonly index: number;
}

/** Greatest size of the comparison table. Beyond it, only equal steps at both ends count as kept. */
const CELLS_MAX = 1_000_000;

export function nameOfStep({ action, objects }: Step): string {
  return [action, ...objects].join(" ").toLowerCase();
}

export function compareSteps<T extends Step>(
  before: readonly T[],
  now: readonly T[],
): readonly ComparedStep<T>[] {
  const [old, fresh] = [before.map(nameOfStep), now.map(nameOfStep)];
  const isSame = (at: number, other: number) => old[at] === fresh[other];
  let first = 0;
  const shorter = Math.min(old.length, fresh.length);
  while (first < shorter && isSame(first, first)) first++;
  let last = 0;
  while (last < shorter - first && isSame(old.length - 1 - last, fresh.length - 1 - last)) last++;
  const middle = common(
    old.slice(first, old.length - last),
    fresh.slice(first, fresh.length - last),
  );
  const kept = now
    .slice(0, first)
    .map((step, index): ComparedStep<T> => ({ step, difference: "kept", index }));
  const end = now.slice(now.length - last).map(
    (step, index): ComparedStep<T> => ({
      step,
      difference: "kept",
      index: now.length - last + index,
    }),
  );
  const changed = middle.flatMap(({ difference, at }): ComparedStep<T>[] => {
    const step = (difference === "removed" ? before : now)[first + at];
    return step ? [{ step, difference, index: first + at }] : [];
  });
  return [...kept, ...changed, ...end];
}

interface StepMove {
  readonly difference: ComparedStep<Step>["difference"];
  readonly at: number;
}

/** Longest common subsequence, as moves from one list to the other. */
function common(old: readonly string[], fresh: readonly string[]): readonly StepMove[] {
  const width = fresh.length + 1;
  const isSmall = (old.length + 1) * width <= CELLS_MAX;
  const longest = new Uint32Array(isSmall ? (old.length + 1) * width : 0);
  const cell = (row: number, column: number) => longest[row * width + column] ?? 0;
  for (let row = old.length - 1; isSmall && row >= 0; row--) {
    for (let column = fresh.length - 1; column >= 0; column--) {
      longest[row * width + column] =
        old[row] === fresh[column]
          ? cell(row + 1, column + 1) + 1
          : Math.max(cell(row + 1, column), cell(row, column + 1));
    }
  }
  const moves: StepMove[] = [];
  let [row, column] = [0, 0];
  while (row < old.length || column < fresh.length) {
    const both = isSmall && row < old.length && column < fresh.length;
    if (both && old[row] === fresh[column]) {
      moves.push({ difference: "kept", at: column++ });
      row++;
    } else if (
      row < old.length &&
      (column >= fresh.length || !both || cell(row + 1, column) >= cell(row, column + 1))
    ) {
      moves.push({ difference: "removed", at: row++ });
    } else moves.push({ difference: "added", at: column++ });
  }
  return moves;
}
