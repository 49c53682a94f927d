/** Execution order of a container's children, for lists: from the start along the transitions, unreachable ones last. */

import { DECIDER_ID, type Machine, startOf, transitionsOf } from "./machine.ts";
import { childPath, idOf } from "./path.ts";

export function inOrder(machine: Machine, container: string): readonly string[] {
  const children = machine.children(container);
  const state = machine.state(container);
  if (!state || children.length < 2) return children;
  const goals = goalsOf(transitionsOf(state));
  const there = new Set(children);
  const found = new Set<string>();
  const start = startOf(state)?.to_state;
  const pending = start == null ? [] : [childPath(container, start)];
  for (let path = pending.pop(); path !== undefined; path = pending.pop()) {
    if (found.has(path) || !there.has(path)) continue;
    found.add(path);
    const next = goals.get(idOf(path)) ?? [];
    pending.push(...next.map((id) => childPath(container, id)).reverse());
  }
  const rest = children.filter((path) => !found.has(path));
  const isDecider = (path: string) => idOf(path) === DECIDER_ID;
  return [...found, ...rest.filter((path) => !isDecider(path)), ...rest.filter(isDecider)];
}

/** Successors of each state: of its first outcome first, of aborted and preempted last. */
function goalsOf(transitions: ReturnType<typeof transitionsOf>): Map<string, string[]> {
  const rank = (outcome: number | null | undefined) =>
    outcome == null || outcome < 0 ? Number.POSITIVE_INFINITY : outcome;
  const between = transitions.filter(
    ({ from_state, to_state }) => from_state != null && to_state != null,
  );
  between.sort((one, other) => {
    const [first, second] = [rank(one.from_outcome), rank(other.from_outcome)];
    return first === second ? 0 : first - second;
  });
  const goals = new Map<string, string[]>();
  for (const { from_state, to_state } of between) {
    const list = goals.get(from_state ?? "") ?? [];
    list.push(to_state ?? "");
    goals.set(from_state ?? "", list);
  }
  return goals;
}
