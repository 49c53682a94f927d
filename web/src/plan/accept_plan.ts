/** Inserts a planner's result into a machine: its hierarchy state in a container, as one edit; and a preview of that. */

import type { Edit, Selection, StateDocument } from "../model/generated/protocol.ts";
import type { Box } from "../model/geometry.ts";
import { rootSize } from "../model/layout_reader.ts";
import { type Machine, outcomesOf, startOf, transitionsOf } from "../model/machine.ts";
import { freshNumber } from "../model/names.ts";
import { childPath } from "../model/path.ts";
import { pins, sizeIn } from "./boxes.ts";
import { drawnInto } from "./documents.ts";
import { containerAt } from "./legal.ts";
import { newBox, newId, newName } from "./newcomers.ts";
import { isRefused, type Plan, type Refused, refused, together } from "./plan.ts";

/** Share of an empty container that a plan fills. */
const SHARE = 0.8;

export interface Accepted extends Plan {
  /** The state that comes. */
  readonly path: string;
  /** All states that come, in the container's coordinates; their paths begin as in the answer. */
  readonly states: readonly StateDocument[];
}

/** Puts the answer into a container. In an empty hierarchy it is the start, and its success that of the hierarchy. */
export function acceptPlan(
  machine: Machine,
  container: string,
  answer: Selection,
): Accepted | Refused {
  const target = containerAt(machine, container);
  if (isRefused(target)) return target;
  const [root] = answer.states ?? [];
  if (!root) return refused("The plan has no state: plan again.");
  const isEmpty = machine.children(container).length === 0;
  const box = isEmpty ? middleBox(machine, container, root) : freeBox(machine, container, root);
  const name = newName(machine, container, root.name);
  const states = drawnInto(answer.states ?? [], box).map((state, index) =>
    index === 0 ? { ...state, name } : state,
  );
  const id = newId(machine, container);
  const edits: Edit[] = [
    ...pins(machine, container, new Set()),
    { edit: "paste", path: container, selection: { ...answer, states: [...states] }, ids: [id] },
    ...(isEmpty ? wholeWay(target, container, root, id) : []),
  ];
  const path = childPath(container, id);
  const select = [{ kind: "state", path } as const];
  return { name: `Accept plan ${name}`, edit: together(edits), select, path, states };
}

/** Start and success of what was empty. */
function wholeWay(
  target: StateDocument,
  path: string,
  root: StateDocument,
  id: string,
): readonly Edit[] {
  if (target.kind !== "hierarchy") return [];
  const edits: Edit[] = startOf(target) ? [] : [{ edit: "set_start", path, to: { state: id } }];
  const from = outcomesOf(root).find((outcome) => outcome.id >= 0);
  const to = outcomesOf(target).find((outcome) => outcome.id >= 0);
  if (!from || !to) return edits;
  const transition = freshNumber(transitionsOf(target));
  return [
    ...edits,
    {
      edit: "add_transition",
      path,
      transition,
      from: { state: id, outcome: from.id },
      to: { outcome: to.id },
    },
  ];
}

function middleBox(machine: Machine, container: string, root: StateDocument): Box {
  const [size, own] = [sizeIn(machine, container), rootSize(root)];
  const factor = SHARE * Math.min(size.width / own.width, size.height / own.height);
  const [width, height] = [own.width * factor, own.height * factor];
  return { x: (size.width - width) / 2, y: (size.height - height) / 2, width, height };
}

function freeBox(machine: Machine, container: string, root: StateDocument): Box {
  const own = rootSize(root);
  return newBox(machine, container, undefined, own.width / own.height);
}
