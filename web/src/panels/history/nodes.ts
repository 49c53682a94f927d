/** Nodes of the history of a run: nested calls, loops with their rounds, and parts of long lists. They are created when their
 * parent opens. */

import { type Calls, NONE } from "../../store/history/calls.ts";
import { type Fold, Folds } from "../../store/history/folds.ts";

export type HistoryNode =
  | { readonly kind: "call"; readonly id: string; readonly call: number }
  | {
      readonly kind: "loop";
      readonly id: string;
      readonly calls: readonly number[];
      readonly period: number;
    }
  | {
      readonly kind: "round";
      readonly id: string;
      /** Number of the round, counted from 1. */
      readonly number: number;
      readonly calls: readonly number[];
    }
  | {
      readonly kind: "part";
      readonly id: string;
      readonly from: number;
      readonly to: number;
      readonly nodes: readonly HistoryNode[];
    };

/** Maximum length of a list. Longer lists are shown in parts of this length. */
const PART = 200;

export class Nodes {
  readonly #calls: Calls;
  readonly #folds = new Map<number, Folds>();

  constructor(calls: Calls) {
    this.#calls = calls;
  }

  /** Calls without an outer call: one for each start of the run. */
  roots(): readonly HistoryNode[] {
    return inParts(this.#calls.inside(NONE).map(callNode), "r");
  }

  /** Content of a node; null if it is empty. */
  inside(node: HistoryNode): readonly HistoryNode[] | null {
    switch (node.kind) {
      case "call":
        return this.#calls.inside(node.call).length === 0 ? null : this.#of(node.call);
      case "part":
        return node.nodes;
      case "round":
        return inParts(node.calls.map(callNode), node.id);
      case "loop":
        return inParts(node.period === 1 ? node.calls.map(callNode) : rounds(node), node.id);
    }
  }

  /** Ids of the nodes that must be open to show a call. */
  ancestors(call: number): readonly string[] {
    const open: string[] = [];
    const outer: number[] = [];
    for (let at = call; at !== NONE; at = this.#calls.parent(at)) outer.unshift(at);
    let nodes = this.roots();
    for (const each of outer) {
      let node = nodes.find((one) => has(one, each));
      while (node && !(node.kind === "call" && node.call === each)) {
        open.push(node.id);
        node = this.inside(node)?.find((one) => has(one, each));
      }
      if (!node) return open;
      if (each !== call) open.push(node.id);
      nodes = this.inside(node) ?? [];
    }
    return open;
  }

  #of(call: number): readonly HistoryNode[] {
    let folds = this.#folds.get(call);
    if (!folds) {
      folds = new Folds((each) => this.#calls.pathNumber(each));
      this.#folds.set(call, folds);
    }
    folds.follow(this.#calls.inside(call));
    return inParts(folds.all.map(foldNode), idOf(call));
  }
}

function idOf(call: number): string {
  return `c${call}`;
}

function callNode(call: number): HistoryNode {
  return { kind: "call", id: idOf(call), call };
}

function foldNode(fold: Fold): HistoryNode {
  if (fold.kind === "call") return callNode(fold.call);
  const { calls, period } = fold;
  return { kind: "loop", id: `l${calls[0] ?? 0}`, calls, period };
}

function rounds({
  id,
  calls,
  period,
}: HistoryNode & { readonly kind: "loop" }): readonly HistoryNode[] {
  return Array.from({ length: Math.ceil(calls.length / period) }, (_, index) => ({
    kind: "round",
    id: `${id}.${index}`,
    number: index + 1,
    calls: calls.slice(index * period, (index + 1) * period),
  }));
}

function inParts(nodes: readonly HistoryNode[], id: string): readonly HistoryNode[] {
  if (nodes.length <= PART) return nodes;
  return Array.from({ length: Math.ceil(nodes.length / PART) }, (_, index) => {
    const part = nodes.slice(index * PART, (index + 1) * PART);
    const from = index * PART + 1;
    return { kind: "part", id: `${id}p${index}`, from, to: from + part.length - 1, nodes: part };
  });
}

/** First and last call of a node. */
export function ends(node: HistoryNode): { readonly first: number; readonly last: number } {
  switch (node.kind) {
    case "call":
      return { first: node.call, last: node.call };
    case "part": {
      const [first, last] = [node.nodes[0], node.nodes.at(-1)];
      return { first: first ? ends(first).first : NONE, last: last ? ends(last).last : NONE };
    }
    default:
      return { first: node.calls[0] ?? NONE, last: node.calls.at(-1) ?? NONE };
  }
}

/** Number of rounds of a loop. Steps backwards do not count. */
export function timesOf(
  { calls, period }: HistoryNode & { readonly kind: "loop" },
  known: Calls,
): number {
  return Math.ceil(visitsIn(calls, known).length / period);
}

/** Duration of a node. For a loop or round it is the sum of its visits, without the time between them. */
export function lengthOf(node: HistoryNode, calls: Calls): number {
  const now_ns = calls.journal.t_ns(calls.journal.length - 1);
  const lasted = (from: number, to: number) => calls.ended_ns(to, now_ns) - calls.began_ns(from);
  if (node.kind === "loop" || node.kind === "round") {
    return visitsIn(node.calls, calls).reduce((sum, call) => sum + lasted(call, call), 0);
  }
  const { first, last } = ends(node);
  return lasted(first, last);
}

function visitsIn(list: readonly number[], calls: Calls): readonly number[] {
  const visits = list.filter((call) => !calls.isBack(call));
  return visits.length === 0 ? list : visits;
}

function has(node: HistoryNode, call: number): boolean {
  const { first, last } = ends(node);
  return call >= first && call <= last;
}
