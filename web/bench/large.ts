/** Writes a machine of 10,000 states in the reference's format: 100 hierarchies in a grid, with 97 to 103 states below each, some
 * of them two levels deeper, with transitions, waypoints and data flows. The same every time. */

import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";

interface Drawn {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

interface Node {
  readonly id: string;
  readonly name: string;
  readonly box: Drawn;
  readonly children: readonly Node[];
  /** How many of the children stand in a line of the grid. */
  readonly columns: number;
}

const LEAF = { width: 120, height: 72 };
const GAP = 44;
const MARGIN = 60;

/** How many states the machine has. */
export const LARGE_STATES = 10_000;

/** Writes the machine into a folder that is not there yet. */
export function writeLarge(folder: string): void {
  const groups = Array.from({ length: 100 }, (_, number) => group(number));
  const root = container("ROOT00", "Survey of ten thousand places", groups, 10, { x: 0, y: 0 });
  writeState(folder, root);
  write(folder, "statemachine.json", {
    creation_time: "2026-01-01 00:00:00",
    state_machine_version: null,
    used_rafcon_version: "2.2.0",
  });
}

/** A hierarchy of 99 states: itself, and below it a grid in which every tenth place is a hierarchy two levels deep. The root takes
 * the place of one of them. */
function group(number: number): Node {
  const children: Node[] = [];
  let left = number === 0 ? 98 : 99;
  for (let place = 0; left > 0; place++) {
    const child = place % 10 === 3 && left >= 9 ? nested(number, place) : leaf(number, place);
    left -= size(child);
    children.push(child);
  }
  return container(id(number, 90), `Area ${number}`, children, 8);
}

/** A hierarchy of two hierarchies: 9 states. */
function nested(number: number, place: number): Node {
  const inner = [0, 1].map((part) => {
    const leaves = [1, 2, 3].map((step) => leaf(number, 100 + place * 10 + part * 4 + step));
    return container(id(number, 200 + place * 2 + part), `Look ${place}.${part}`, leaves, 3);
  });
  return container(id(number, 400 + place), `Search place ${place}`, inner, 1);
}

function leaf(number: number, place: number): Node {
  const box = { x: 0, y: 0, ...LEAF };
  const name = NAMES[(number * 7 + place) % NAMES.length] ?? "Wait";
  return { id: id(number, 500 + place), name, box, children: [], columns: 1 };
}

const NAMES = [
  "Drive to the next place",
  "Take a scan",
  "Merge the scan into the map",
  "Look closely",
  "Close the gripper",
  "Report",
  "Wait for the link",
  "Decide",
] as const;

/** Six capital letters, different for every number. */
function id(group: number, place: number): string {
  let rest = group * 2000 + place;
  let letters = "";
  for (let at = 0; at < 6; at++) {
    letters += String.fromCharCode(65 + (rest % 26));
    rest = Math.floor(rest / 26);
  }
  return letters;
}

function size(node: Node): number {
  return 1 + node.children.reduce((sum, child) => sum + size(child), 0);
}

/** A state around others, which are put into lines. */
function container(
  id: string,
  name: string,
  nodes: readonly Node[],
  columns: number,
  at = { x: 0, y: 0 },
): Node {
  const children: Node[] = [];
  let [x, y, bottom, right] = [MARGIN, MARGIN, MARGIN, MARGIN];
  nodes.forEach((node, number) => {
    if (number > 0 && number % columns === 0) [x, y] = [MARGIN, bottom + GAP];
    children.push({ ...node, box: { ...node.box, x, y } });
    x += node.box.width + GAP;
    right = Math.max(right, x - GAP);
    bottom = Math.max(bottom, y + node.box.height);
  });
  const box = { ...at, width: right + MARGIN, height: bottom + MARGIN };
  return { id, name, box, children, columns };
}

function writeState(folder: string, node: Node): void {
  mkdirSync(folder, { recursive: true });
  write(folder, "core_data.json", node.children.length > 0 ? hierarchy(node) : execution(node));
  write(folder, "meta_data.json", meta(node));
  if (node.children.length === 0) writeFileSync(join(folder, "script.py"), SCRIPT);
  for (const child of node.children) {
    writeState(join(folder, `${child.name.replaceAll(/[^A-Za-z0-9]/g, "_")}_${child.id}`), child);
  }
}

const SCRIPT =
  'def execute(self, inputs, outputs, gvm):\n    outputs["to"] = inputs["from"] + 1\n    return "success"\n';

function execution(node: Node) {
  return { __jsonqualname__: `${STATES}.execution_state.ExecutionState`, ...common(node) };
}

/** Children after each other, each fed by the one before; the first child by the container, the container by the last. */
function hierarchy(node: Node) {
  const transitions: Record<string, unknown> = {};
  const flows: Record<string, unknown> = {};
  [...node.children, null].forEach((child, at) => {
    const before = node.children[at - 1];
    transitions[at] = {
      __jsonqualname__: `${ELEMENTS}.transition.Transition`,
      transition_id: at,
      from_state: before?.id ?? null,
      from_outcome: before ? 0 : null,
      to_state: child?.id ?? node.id,
      to_outcome: child ? null : 0,
    };
    flows[at] = {
      __jsonqualname__: `${ELEMENTS}.data_flow.DataFlow`,
      data_flow_id: at,
      from_state: before?.id ?? node.id,
      from_key: before ? 1 : 0,
      to_state: child?.id ?? node.id,
      to_key: child ? 0 : 1,
    };
  });
  return {
    __jsonqualname__: `${STATES}.hierarchy_state.HierarchyState`,
    ...common(node),
    scoped_variables: {},
    transitions,
    data_flows: flows,
  };
}

const STATES = "rafcon.core.states";
const ELEMENTS = "rafcon.core.state_elements";

function common(node: Node) {
  const outcome = (id: number, name: string) => ({
    __jsonqualname__: `${ELEMENTS}.logical_port.Outcome`,
    outcome_id: id,
    name,
  });
  const port = (kind: "Input" | "Output", id: number, name: string) => ({
    __jsonqualname__: `${ELEMENTS}.data_port.${kind}DataPort`,
    data_port_id: id,
    name,
    data_type: { __type__: "__builtin__.int" },
    default_value: 0,
  });
  return {
    name: node.name,
    state_id: node.id,
    description: null,
    income: { __jsonqualname__: `${ELEMENTS}.logical_port.Income` },
    outcomes: {
      "-1": outcome(-1, "aborted"),
      "-2": outcome(-2, "preempted"),
      "0": outcome(0, "success"),
    },
    input_data_ports: { "0": port("Input", 0, "from") },
    output_data_ports: { "1": port("Output", 1, "to") },
  };
}

/** The layout: place, size, name; a transition that begins a new line goes round by waypoints. */
function meta(node: Node) {
  const own = {
    rel_pos: tuple(node.box.x, node.box.y),
    size: tuple(node.box.width, node.box.height),
  };
  if (node.children.length === 0) return { gui: { editor_gaphas: own } };
  const all: Record<string, unknown> = {
    gui: {
      editor_gaphas: {
        ...own,
        name: { rel_pos: tuple(12, 10), size: tuple(node.box.width - 24, 34) },
      },
    },
  };
  node.children.forEach((child, at) => {
    const before = node.children[at - 1];
    if (!before || at % node.columns !== 0) return;
    const y = child.box.y - GAP / 2;
    const points = [tuple(before.box.x + before.box.width + GAP / 2, y), tuple(MARGIN / 2, y)];
    all[`transition${at}`] = { gui: { editor_gaphas: { waypoints: points } } };
  });
  return all;
}

function tuple(...items: readonly number[]) {
  return { __jsonqualname__: "__builtin__.tuple", items };
}

function write(folder: string, name: string, content: unknown): void {
  writeFileSync(join(folder, name), `${JSON.stringify(content, null, 4)}`);
}
