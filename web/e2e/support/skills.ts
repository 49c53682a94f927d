/** Libraries of skills that a planner knows, and the engine that plans with them. */

import { existsSync, mkdirSync, mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { REPOSITORY } from "./places.ts";

interface Skill {
  readonly id: string;
  readonly name: string;
  readonly inputs: readonly string[];
  readonly action: string;
  readonly predicates: string;
  readonly types: string;
}

const DRIVE: Skill = {
  id: "DRIVEX",
  name: "Drive",
  inputs: ["from", "to"],
  action: `(:action drive :parameters (?from ?to - Place)
    :precondition (rover-at ?from)
    :effect (and (not (rover-at ?from)) (rover-at ?to)))`,
  predicates: "(rover-at ?place - Place)",
  types: "Place",
};

const PICK: Skill = {
  id: "PICKXX",
  name: "Pick",
  inputs: ["thing", "place"],
  action: `(:action pick :parameters (?thing - Thing ?place - Place)
    :precondition (and (rover-at ?place) (at ?thing ?place) (hand-empty))
    :effect (and (not (at ?thing ?place)) (not (hand-empty)) (holding ?thing)))`,
  predicates:
    "(rover-at ?place - Place) (at ?thing - Thing ?place - Place) (holding ?thing - Thing) (hand-empty)",
  types: "Thing, Place",
};

const PUT: Skill = {
  id: "PUTXXX",
  name: "Put",
  inputs: ["thing", "place"],
  action: `(:action put :parameters (?thing - Thing ?place - Place)
    :precondition (and (rover-at ?place) (holding ?thing))
    :effect (and (not (holding ?thing)) (hand-empty) (at ?thing ?place)))`,
  predicates:
    "(rover-at ?place - Place) (at ?thing - Thing ?place - Place) (holding ?thing - Thing) (hand-empty)",
  types: "Thing, Place",
};

/** What a rover can do that fetches things, and in a folder beside it a skill that contradicts them. */
export function roverSkills(): string {
  const folder = mkdtempSync(join(tmpdir(), "rafcon-skills-"));
  for (const skill of [DRIVE, PICK, PUT]) writeSkill(join(folder, "rover"), skill);
  const predicates = "(rover-at ?thing - Thing ?place - Place) (hand-empty)";
  const action = `(:action park :parameters (?thing - Thing ?place - Place)
    :precondition (hand-empty) :effect (rover-at ?thing ?place))`;
  const inputs = ["thing", "place"];
  const park = { id: "PARKXX", name: "Park", inputs, types: "Thing, Place" };
  writeSkill(join(folder, "odd"), { ...park, action, predicates });
  return folder;
}

/** The engine of the planner that journeys use. */
export function engine(): string {
  const found = process.env["RAFCON_KAIROS"] ?? join(REPOSITORY, "target/engine-venv/bin/kairos");
  if (existsSync(found)) return found;
  throw new Error(
    `there is no ${found}: \`cargo xtask test browser\` installs it, RAFCON_KAIROS names another`,
  );
}

const ELEMENTS = "rafcon.core.state_elements";

function writeSkill(root: string, skill: Skill): void {
  const folder = join(root, skill.name.toLowerCase());
  mkdirSync(folder, { recursive: true });
  const write = (file: string, content: unknown) =>
    writeFileSync(join(folder, file), JSON.stringify(content, null, 2));
  write("statemachine.json", {
    creation_time: "2026-11-25 12:00:00",
    used_rafcon_version: "2.5.2",
    version: null,
    root_state_storage_id: "",
  });
  write("meta_data.json", {});
  write("semantic_data.json", {
    RAFCONTPP: {
      PDDL_ACTION: {
        pddl_action: skill.action,
        pddl_predicates: skill.predicates,
        pddl_types: skill.types,
        requirements: [":strips", ":typing"],
        description: "",
      },
    },
  });
  const script = 'def execute(self, inputs, outputs, gvm):\n    return "success"\n';
  writeFileSync(join(folder, "script.py"), script);
  write("core_data.json", coreOf(skill));
}

function coreOf({ id, name, inputs }: Skill) {
  const ports = inputs.map((port, at) => [
    at,
    {
      __jsonqualname__: `${ELEMENTS}.data_port.InputDataPort`,
      data_port_id: at,
      data_type: { __type__: "__builtin__.str" },
      default_value: null,
      name: port,
    },
  ]);
  const outcome = (number: number, title: string) => [
    number,
    {
      __jsonqualname__: `${ELEMENTS}.logical_port.Outcome`,
      name: title,
      outcome_id: number,
    },
  ];
  return {
    __jsonqualname__: "rafcon.core.states.execution_state.ExecutionState",
    state_id: id,
    name,
    description: null,
    income: { __jsonqualname__: `${ELEMENTS}.logical_port.Income` },
    input_data_ports: Object.fromEntries(ports),
    output_data_ports: {},
    outcomes: Object.fromEntries([
      outcome(-2, "preempted"),
      outcome(-1, "aborted"),
      outcome(0, "success"),
    ]),
  };
}
