/** Which of the two runs is meant, and how its moment is shown. */

export type ComparedSide = "one" | "other";

/** Shows a run at the moment after one of its events. */
export type ShowCompared = (side: ComparedSide, sequence: number) => unknown;
