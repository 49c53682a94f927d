/** Types for showing a moment of one of the compared runs. */

export type ComparedSide = "one" | "other";

/** Shows a run at the moment after one of its events. */
export type ShowCompared = (side: ComparedSide, sequence: number) => unknown;
