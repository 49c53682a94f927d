/** Which of the two runs is meant, and how its moment is shown. */

export type Side = "one" | "other";

/** Shows a run at the moment after one of its events. */
export type Show = (side: Side, sequence: number) => unknown;
