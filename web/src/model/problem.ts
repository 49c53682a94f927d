/** Problems of a machine: their elements and their order. */

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

/** Element of a problem; the state if the part is not an element. */
export function elementOfProblem({ path, part }: MachineProblem): ElementRef {
  const [, word, id] = PART.exec(part) ?? [];
  if (word === undefined) return { kind: "state", path };
  return { kind: KINDS[word as keyof typeof KINDS], path, id: Number(id) };
}

/** Message without the place, for display beside it. */
export function withoutPlace({ path, part, message }: MachineProblem): string {
  const place = `${path}, ${part}: `;
  return message.startsWith(place) ? message.slice(place.length) : message;
}

const ORDER: readonly Severity[] = ["error", "warning", "note"];

/** Sorts by severity, otherwise in the order of the machine. */
export function byWeight(problems: readonly MachineProblem[]): readonly MachineProblem[] {
  const weight = ({ severity }: MachineProblem) => ORDER.indexOf(severity);
  return problems.toSorted((one, other) => weight(one) - weight(other));
}

/** Number of errors and warnings. */
export function countProblems(problems: readonly MachineProblem[]): number {
  return problems.filter(({ severity }) => severity !== "note").length;
}
