/** Machines for missions that ask, fail and take their time, written in RAFCON's own format; and what journeys about runs do. */

import { mkdirSync, mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { vi } from "vitest";
import type { RunNow, RunSummary } from "../../src/model/generated/protocol.ts";
import type { App } from "./app.ts";
import { PATIENCE } from "./patience.ts";
import type { Server } from "./server.ts";

/** One state of a mission. It goes on to the next one, whether it ends by success or by aborted. */
export interface Step {
  readonly id: string;
  readonly name: string;
  /** The lines of `execute`. */
  readonly script: readonly string[];
}

const ELEMENTS = "rafcon.core.state_elements";

/** Writes a mission of steps, one after the other or none, into a folder of its own. */
export function missionFolder(name: string, steps: readonly Step[]): string {
  const folder = join(mkdtempSync(join(tmpdir(), "rafcon-mission-")), name);
  mkdirSync(folder);
  write(folder, "statemachine.json", {
    creation_time: "2026-11-21 12:00:00",
    state_machine_version: null,
    used_rafcon_version: "2.5.2",
  });
  write(folder, "meta_data.json", {});
  const next = [...steps.slice(1).map(({ id }) => id), null];
  const ways = steps.flatMap(({ id }, at) => [
    { from: id, outcome: 0, to: next[at] ?? null },
    { from: id, outcome: -1, to: next[at] ?? null },
  ]);
  const start = steps.map(({ id }) => ({ from: null, outcome: null, to: id })).slice(0, 1);
  const all = [...start, ...ways];
  const transitions = all.map(({ from, outcome, to }, at) => [
    at + 1,
    {
      __jsonqualname__: `${ELEMENTS}.transition.Transition`,
      transition_id: at + 1,
      from_state: from,
      from_outcome: outcome,
      to_state: to ?? "MISSIO",
      to_outcome: to === null ? 0 : null,
    },
  ]);
  write(folder, "core_data.json", {
    __jsonqualname__: "rafcon.core.states.hierarchy_state.HierarchyState",
    ...state("MISSIO", name),
    data_flows: {},
    scoped_variables: {},
    transitions: Object.fromEntries(transitions),
  });
  for (const step of steps) writeStep(folder, step);
  return folder;
}

function writeStep(folder: string, { id, name, script }: Step): void {
  const own = join(folder, `${name.replaceAll(" ", "_")}_${id}`);
  mkdirSync(own);
  write(own, "core_data.json", {
    __jsonqualname__: "rafcon.core.states.execution_state.ExecutionState",
    ...state(id, name),
  });
  write(own, "meta_data.json", {});
  const lines = [
    "def execute(self, inputs, outputs, gvm):",
    ...script.map((line) => `    ${line}`),
  ];
  writeFileSync(join(own, "script.py"), `${lines.join("\n")}\n`);
}

function state(id: string, name: string) {
  const outcome = (number: number, title: string) => [
    number,
    {
      __jsonqualname__: `${ELEMENTS}.logical_port.Outcome`,
      name: title,
      outcome_id: number,
    },
  ];
  const outcomes = [outcome(-2, "preempted"), outcome(-1, "aborted"), outcome(0, "success")];
  return {
    state_id: id,
    name,
    description: null,
    income: { __jsonqualname__: `${ELEMENTS}.logical_port.Income` },
    input_data_ports: {},
    output_data_ports: {},
    outcomes: Object.fromEntries(outcomes),
  };
}

function write(folder: string, file: string, content: unknown): void {
  writeFileSync(join(folder, file), JSON.stringify(content, null, 2));
}

/** Starts a run of a machine of the project `missions` as the owner. */
export async function startRun(server: Server, path: string): Promise<string> {
  const [project] = await server.ask<readonly { readonly id: string }[]>("GET", "/projects");
  const machine = { project: project?.id, path };
  const more = { inputs: {}, keeping: "full", breakpoints: [] };
  const id = `journey-${path}-${Date.now()}`;
  const run = await server.ask<RunSummary>("POST", "/runs", { id, machine, ...more });
  return run.id;
}

/** Ends a run if it goes on, whoever is in control of it. */
export async function endRun(server: Server, run: string): Promise<void> {
  const now = await server.ask<RunNow>("GET", `/runs/${run}`);
  if (now.run.phase !== "live") return;
  const stop = { id: `end-${run}-${Date.now()}`, command: { type: "stop" } };
  await server.ask("POST", `/runs/${run}/commands`, stop);
}

/** Shows a run in mission control by its list of runs. */
export async function openMission(app: App, name: string): Promise<void> {
  await app.sheet.keyboard.press("Control+Alt+m");
  const runs = app.sheet.getByRole("list", { name: "Active runs" });
  await runs.getByRole("button", { name }).click();
  await status(app).waitFor();
}

/** Mission control, wherever it stands. */
export function missionOf(app: App) {
  return app.sheet.locator(".mission");
}

/** Who is in control, in mission control. */
export function control(app: App) {
  return missionOf(app).getByRole("region", { name: "Control of the run" });
}

/** State of the run, in mission control. */
export function status(app: App) {
  return app.sheet.getByRole("status", { name: "State of the run" });
}

/** Waits until the run is over for this page. */
export async function untilOver(app: App): Promise<void> {
  await status(app).getByText("finished").waitFor();
}

/** Waits for what may take longer than a person's patience: so long as silence has to last. */
export async function eventually(look: () => Promise<boolean>): Promise<void> {
  await vi.waitUntil(look, PATIENCE);
}
