/** A machine for journeys with values: a loop that senses, with a nested dict, an array and a number that rises, and a state that
 * fails for good at its end. Runs for so many rounds. */

import { mkdirSync, mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

type Json = Readonly<Record<string, unknown>>;

const ELEMENTS = "rafcon.core.state_elements";

function outcomes(...names: readonly string[]): Json {
  const all = [
    [-2, "preempted"],
    [-1, "aborted"],
    ...names.map((name, id) => [id, name] as const),
  ] as const;
  return Object.fromEntries(
    all.map(([id, name]) => [
      String(id),
      { __jsonqualname__: `${ELEMENTS}.logical_port.Outcome`, name, outcome_id: id },
    ]),
  );
}

function ports(
  of: "InputDataPort" | "OutputDataPort",
  names: Readonly<Record<string, string>>,
): Json {
  return Object.fromEntries(
    Object.entries(names).map(([name, type], id) => [
      String(id + (of === "OutputDataPort" ? 10 : 0)),
      {
        __jsonqualname__: `${ELEMENTS}.data_port.${of}`,
        data_port_id: id + (of === "OutputDataPort" ? 10 : 0),
        data_type: { __type__: `__builtin__.${type}` },
        default_value: null,
        name,
      },
    ]),
  );
}

function transition(
  id: number,
  from: readonly [string | null, number | null],
  to: readonly [string, number | null],
): Json {
  return {
    __jsonqualname__: `${ELEMENTS}.transition.Transition`,
    transition_id: id,
    from_state: from[0],
    from_outcome: from[1],
    to_state: to[0],
    to_outcome: to[1],
  };
}

function flow(id: number, from: readonly [string, number], to: readonly [string, number]): Json {
  return {
    __jsonqualname__: `${ELEMENTS}.data_flow.DataFlow`,
    data_flow_id: id,
    from_state: from[0],
    from_key: from[1],
    to_state: to[0],
    to_key: to[1],
  };
}

function byId(key: string, all: readonly Json[]): Json {
  return Object.fromEntries(all.map((each) => [String(each[key]), each]));
}

/** The script of the state that senses. The array is of numpy where it is; else it is what has the same of it. */
const SENSE = `import time

try:
    import numpy
except ImportError:
    numpy = None


class Kind:
    kind = "f"

    def __str__(self):
        return "float64"


class Ranges:
    """What arrays have in common."""

    def __init__(self, items):
        self.items, self.shape, self.dtype = items, (len(items),), Kind()

    def __getitem__(self, slices):
        return Ranges(self.items[slices[0]])

    def tolist(self):
        return self.items


def execute(self, inputs, outputs, gvm):
    count = inputs["count"] + 1
    ranges = [float(count * index) for index in range(500)]
    outputs["count"] = count
    outputs["pose"] = {"frame": "map", "position": [count, 2.5, -1.0], "joints": {"elbow": count / 4}}
    outputs["ranges"] = numpy.array(ranges) if numpy else Ranges(ranges)
    outputs["found"] = [{"name": "cup", "x": count}, {"name": "box", "x": 2 * count}]
    gvm.set_variable("last count", count)
    time.sleep(PAUSE)
    return "again" if count < ROUNDS else "done"
`;

const FAIL = `def reach(pose):
    raise ValueError("the cup is out of reach")


def execute(self, inputs, outputs, gvm):
    reach(inputs["pose"])
    return "success"
`;

export interface Sensing {
  /** How often it senses before it fails. */
  readonly rounds: number;
  /** How long it takes each time. */
  readonly pause_s: number;
}

/** A new folder with the machine. */
export function sensing({ rounds, pause_s }: Sensing): string {
  const folder = join(mkdtempSync(join(tmpdir(), "rafcon-sensing-")), "sensing");
  const write = (path: string, name: string, content: string | Json) => {
    mkdirSync(join(folder, path), { recursive: true });
    const text = typeof content === "string" ? content : JSON.stringify(content, null, 4);
    writeFileSync(join(folder, path, name), text);
  };
  write("", "statemachine.json", {
    creation_time: "2026-11-22 12:00:00",
    state_machine_version: null,
    used_rafcon_version: "2.5.2",
  });
  write("", "core_data.json", root());
  const inside = (name: string, id: string) => `${name}_${id}`;
  write(
    inside("Look", "LOOKIN"),
    "core_data.json",
    execution(
      "Look",
      "LOOKIN",
      ["again", "done"],
      { count: "int" },
      {
        count: "int",
        pose: "dict",
        ranges: "object",
        found: "list",
      },
    ),
  );
  const script = SENSE.replace("ROUNDS", String(rounds)).replace("PAUSE", String(pause_s));
  write(inside("Look", "LOOKIN"), "script.py", script);
  write(
    inside("Grasp", "GRASPS"),
    "core_data.json",
    execution("Grasp", "GRASPS", ["success"], { pose: "dict" }, {}),
  );
  write(inside("Grasp", "GRASPS"), "script.py", FAIL);
  return folder;
}

function execution(
  name: string,
  id: string,
  ends: readonly string[],
  inputs: Readonly<Record<string, string>>,
  outputs: Readonly<Record<string, string>>,
): Json {
  return {
    __jsonqualname__: "rafcon.core.states.execution_state.ExecutionState",
    name,
    state_id: id,
    description: null,
    income: { __jsonqualname__: `${ELEMENTS}.logical_port.Income` },
    input_data_ports: ports("InputDataPort", inputs),
    output_data_ports: ports("OutputDataPort", outputs),
    outcomes: outcomes(...ends),
  };
}

function root(): Json {
  const start = transition(0, [null, null], ["LOOKIN", null]);
  const again = transition(1, ["LOOKIN", 0], ["LOOKIN", null]);
  const done = transition(2, ["LOOKIN", 1], ["GRASPS", null]);
  const end = transition(3, ["GRASPS", 0], ["SENSES", 0]);
  const variable = {
    __jsonqualname__: `${ELEMENTS}.scope.ScopedVariable`,
    data_port_id: 20,
    data_type: { __type__: "__builtin__.int" },
    default_value: 0,
    name: "count",
  };
  return {
    __jsonqualname__: "rafcon.core.states.hierarchy_state.HierarchyState",
    name: "Senses",
    state_id: "SENSES",
    description: null,
    income: { __jsonqualname__: `${ELEMENTS}.logical_port.Income` },
    start_state_id: "LOOKIN",
    input_data_ports: {},
    output_data_ports: {},
    outcomes: outcomes("success"),
    scoped_variables: { "20": variable },
    transitions: byId("transition_id", [start, again, done, end]),
    data_flows: byId("data_flow_id", [
      flow(0, ["SENSES", 20], ["LOOKIN", 0]),
      flow(1, ["LOOKIN", 10], ["SENSES", 20]),
      flow(2, ["LOOKIN", 11], ["GRASPS", 0]),
    ]),
  };
}
