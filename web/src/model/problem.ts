/** Problems of a machine: which element each is about, and which come first. */

import type { ElementRef } from "./element.ts";
import type { MachineProblem, Severity } from "./generated/protocol.ts";

const KINDS = {
  outcome: "outcome",
  input: "input",
  output: "output",
  "scoped variable": "scoped_variable",
  transition: "transition",
  "data flow": "data_flow",
} as const;

const PART =
  /^(?:runtime value of )?(outcome|input|output|scoped variable|transition|data flow) (-?\d+)$/;

/** The part that a problem is about; the state, if it is no part that has a place. */
export function elementOfProblem({ path, part }: MachineProblem): ElementRef {
  const [, word, id] = PART.exec(part) ?? [];
  if (word === undefined) return { kind: "state", path };
  return { kind: KINDS[word as keyof typeof KINDS], path, id: Number(id) };
}

/** What is wrong, without the place, where that is told beside it. */
export function withoutPlace({ path, part, message }: MachineProblem): string {
  const place = `${path}, ${part}: `;
  return message.startsWith(place) ? message.slice(place.length) : message;
}

const ORDER: readonly Severity[] = ["error", "warning", "note"];

/** The worst first, in the order of the machine otherwise. */
export function byWeight(problems: readonly MachineProblem[]): readonly MachineProblem[] {
  const weight = ({ severity }: MachineProblem) => ORDER.indexOf(severity);
  return problems.toSorted((one, other) => weight(one) - weight(other));
}

/** How many want to be seen: what is no more than a note does not. */
export function countProblems(problems: readonly MachineProblem[]): number {
  return problems.filter(({ severity }) => severity !== "note").length;
}
