/** Copying, pasting and duplicating states with what connects them. */

import type { ElementRef } from "../model/element.ts";
import type { Selection, StateDocument } from "../model/generated/protocol.ts";
import { around, type Box, type Point } from "../model/geometry.ts";
import { dataFlowsOf, type Machine, portsOf, transitionsOf } from "../model/machine.ts";
import { childPath, idOf, parentOf } from "../model/path.ts";
import { boxIn, childBoxes, inside, pins, sizeIn } from "./boxes.ts";
import { besides, drawnBox, drawnInto, placedDocumentsOf, separate } from "./documents.ts";
import { commonContainer, containerAt, counted } from "./legal.ts";
import { arrivingIds, statesInWords } from "./move.ts";
import { isRefused, type Plan, type Planned, type Refused, refused, together } from "./plan.ts";

/** The states and scoped variables among the elements, of the container that has most of them, and what is between. */
export function copySelection(
  machine: Machine,
  elements: readonly ElementRef[],
): Selection | Refused {
  const container = commonest(elements);
  const state = container === null ? undefined : machine.state(container);
  if (container === null || !state) {
    return refused("Select states inside the machine, or scoped variables, to copy them.");
  }
  const own = elements.filter((element) => containerOf(element) === container);
  const paths = own
    .filter(({ kind, path }) => kind === "state" && machine.state(path)?.kind !== "decider")
    .map(({ path }) => path);
  const variables = own.flatMap((element) =>
    element.kind === "scoped_variable" ? [element.id] : [],
  );
  if (paths.length === 0 && variables.length === 0) {
    return refused("A decider belongs to its barrier: copy the barrier, or other states.");
  }
  const ids = new Set(paths.map(idOf));
  return {
    container: idOf(container),
    states: paths.flatMap((path) => placedDocumentsOf(machine, path)),
    scoped_variables: portsOf(state, "scoped_variable").filter(({ id }) => variables.includes(id)),
    ...between(state, idOf(container), ids, variables),
  };
}

/** The container of what can be copied. */
function containerOf({ kind, path }: ElementRef): string | null {
  if (kind === "state") return parentOf(path);
  return kind === "scoped_variable" ? path : null;
}

function commonest(elements: readonly ElementRef[]): string | null {
  const counts = new Map<string, number>();
  for (const element of elements) {
    const container = containerOf(element);
    if (container !== null) counts.set(container, (counts.get(container) ?? 0) + 1);
  }
  const most = [...counts].reduce<[string, number] | null>(
    (best, next) => (best && best[1] >= next[1] ? best : next),
    null,
  );
  return most?.[0] ?? null;
}

function between(
  state: StateDocument,
  container: string,
  ids: ReadonlySet<string>,
  variables: readonly number[],
) {
  const isEnd = (id: string, port: number) =>
    ids.has(id) || (id === container && variables.includes(port));
  return {
    transitions: transitionsOf(state).filter(
      ({ from_state, to_state }) => ids.has(from_state ?? "") && ids.has(to_state ?? ""),
    ),
    data_flows: dataFlowsOf(state).filter(
      (flow) => isEnd(flow.from_state, flow.from_port) && isEnd(flow.to_state, flow.to_port),
    ),
  };
}

/** Puts copied states into a container, their middle at the point, or else near where they were. They are made smaller if
 * they are too large for it. */
export function paste(
  machine: Machine,
  container: string,
  selection: Selection,
  at?: Point,
): Planned {
  const bounds = boundsOf(selection);
  const middle = at && bounds && { x: at.x - bounds.width / 2, y: at.y - bounds.height / 2 };
  return pasted(machine, container, selection, middle, "Paste");
}

function boundsOf(selection: Selection): Box | null {
  const roots = separate(selection.states ?? []).flatMap(([first]) => first ?? []);
  return around(roots.map(drawnBox));
}

function pasted(
  machine: Machine,
  container: string,
  selection: Selection,
  corner: Point | null | undefined,
  verb: string,
): Planned {
  const target = containerAt(machine, container);
  if (isRefused(target)) return target;
  const copies = separate(selection.states ?? []);
  const old = copies.map(([first]) => first?.path ?? "");
  const ids = arrivingIds(machine, container, old);
  const states = copies.length === 0 ? [] : fitted(machine, container, copies, corner);
  const count = copies.length + (selection.scoped_variables?.length ?? 0);
  if (count === 0) return refused("Nothing was copied yet: select states and copy them first.");
  const what = copies.length > 0 ? counted(copies.length, "state") : "scoped variables";
  const plan: Plan = {
    name: `${verb} ${what}`,
    edit: together([
      ...pins(machine, container, new Set()),
      { edit: "paste", path: container, selection: { ...selection, states }, ids: [...ids] },
    ]),
    select: ids.map((id) => ({ kind: "state", path: childPath(container, id) })),
  };
  return plan;
}

/** The copies where they come to stand, as large as there is room. */
function fitted(
  machine: Machine,
  container: string,
  copies: readonly StateDocument[][],
  corner: Point | null | undefined,
): StateDocument[] {
  const size = sizeIn(machine, container);
  const boxes = copies.map(([first], index) => (first ? drawnBox(first, index) : null));
  const bounds = around(boxes.filter((box) => box !== null));
  if (!bounds) return copies.flat();
  const factor = Math.min(
    1,
    (0.8 * size.width) / bounds.width,
    (0.8 * size.height) / bounds.height,
  );
  const whole = { width: bounds.width * factor, height: bounds.height * factor };
  const taken = [...childBoxes(machine, container).values()];
  const first = { ...bounds, width: whole.width, height: whole.height };
  const at = corner ?? besides(inside(first, size), first, taken);
  const place = inside({ ...whole, ...at }, size);
  return copies.flatMap((states, index) => {
    const box = boxes[index];
    if (!box) return states;
    return drawnInto(states, {
      x: place.x + (box.x - bounds.x) * factor,
      y: place.y + (box.y - bounds.y) * factor,
      width: box.width * factor,
      height: box.height * factor,
    });
  });
}

/** Copies states beside themselves. */
export function duplicate(machine: Machine, paths: readonly string[], by: Point): Planned {
  const container = commonContainer(machine, paths);
  if (typeof container !== "string") return container;
  const selection = copySelection(
    machine,
    paths.map((path) => ({ kind: "state", path })),
  );
  if (isRefused(selection)) return selection;
  const bounds = around(paths.map((path) => boxIn(machine, path)));
  const corner = bounds && { x: bounds.x + by.x, y: bounds.y + by.y };
  const plan = pasted(machine, container, selection, corner, "Duplicate");
  return isRefused(plan) ? plan : { ...plan, name: `Duplicate ${statesInWords(machine, paths)}` };
}
