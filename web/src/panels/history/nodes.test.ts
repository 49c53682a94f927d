import { expect, test } from "vitest";
import { Calls } from "../../store/history/calls.ts";
import { Journal } from "../../store/history/journal.ts";
import { events, randomRun } from "../../store/testing/events.ts";
import { type HistoryNode, lengthOf, Nodes, timesOf } from "./nodes.ts";

function callsFrom(entries: Parameters<Journal["add"]>[0]): Calls {
  const journal = new Journal();
  journal.add(entries, entries.length + 1);
  const calls = new Calls(journal);
  calls.follow();
  return calls;
}

function written(calls: Calls, nodes: Nodes): string {
  const write = (node: HistoryNode, depth: number): string => {
    const words =
      node.kind === "call"
        ? calls.path(node.call)
        : node.kind === "loop"
          ? `loop of ${node.calls.length / node.period}`
          : node.kind === "round"
            ? `round ${node.number}`
            : `${node.from} to ${node.to}`;
    const inside = (nodes.inside(node) ?? []).map((inner) => write(inner, depth + 1));
    return [`${"  ".repeat(depth)}${words}`, ...inside].join("\n");
  };
  return nodes
    .roots()
    .map((root) => write(root, 0))
    .join("\n");
}

test("calls stand inside one another, what repeats as a loop of rounds", () => {
  const calls = callsFrom(
    events(`> R
      > R/A
      < R/A done
      > R/B
      > R/B/C
      < R/B/C done
      < R/B done
      > R/A
      < R/A done
      > R/B
      < R/B done
      > R/D`),
  );
  expect(written(calls, new Nodes(calls))).toBe(`R
  loop of 2
    round 1
      R/A
      R/B
        R/B/C
    round 2
      R/A
      R/B
  R/D`);
});

test("a long list stands in parts, and the way to each call is known", () => {
  const calls = callsFrom(randomRun(5, 5_000));
  const nodes = new Nodes(calls);
  const find = (all: readonly HistoryNode[], open: readonly string[], call: number): boolean => {
    const [next, ...rest] = open;
    if (next === undefined) return all.some((node) => node.kind === "call" && node.call === call);
    const node = all.find(({ id }) => id === next);
    return node !== undefined && find(nodes.inside(node) ?? [], rest, call);
  };
  for (let call = 0; call < calls.length; call += 97) {
    expect(find(nodes.roots(), nodes.ancestors(call), call)).toBe(true);
  }
  const first = nodes.inside(nodes.roots()[0] ?? { kind: "call", id: "", call: 0 }) ?? [];
  expect(first.length).toBeLessThanOrEqual(200);
});

test("a loop counts visits as the inspector does, without steps back, and lasts as long as they did", () => {
  const calls = callsFrom(
    events(`> R
      > R/A
      < R/A done
      > R/A!
      = R/A held
      = R/A held
      < R/A!
      > R/A
      < R/A done`),
  );
  const nodes = new Nodes(calls);
  const [root] = nodes.roots();
  const [loop] = (root && nodes.inside(root)) ?? [];
  expect(loop?.kind === "loop" && timesOf(loop, calls)).toBe(2);
  expect(loop && lengthOf(loop, calls)).toBe(2_000_000);
  expect(root && lengthOf(root, calls)).toBe(8_000_000);
});
