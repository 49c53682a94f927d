/** Long runs, made as fast as scripts run: the packer, whose scripts wait for nothing. Of about every thousandth part it says so in the log,
 * and one part falls. */

import type { RunNow, RunSummary } from "../../src/model/generated/protocol.ts";
import { exampleWith } from "./runs.ts";
import type { Server } from "./server.ts";

/** The part that falls: early in any long run. */
export const FALLEN = 1_234;

/** So many events come with a part, about. */
const EVENTS_A_PART = 12;

/** The machine. */
export const FAST_PACKER = exampleWith("hierarchy_and_data", {
  "Pack_one_part_ONEPAR/Place_in_the_box_PLACEI/script.py": [
    "def execute(self, inputs, outputs, gvm):",
    '    outputs["count"] = inputs["count"] + 1',
    '    outputs["weight_g"] = inputs["weight_g"] + inputs["part_g"]',
    `    if outputs["count"] == ${FALLEN}:`,
    `        self.logger.warning("part ${FALLEN} fell from the gripper")`,
    '    return "success"',
    "",
  ].join("\n"),
  "Is_the_box_full_ISFULL/script.py": [
    "def execute(self, inputs, outputs, gvm):",
    '    count, wanted = inputs["count"], inputs["wanted"]',
    "    if count % 1000 == 0:",
    '        self.logger.info("%d of %d parts are in the box", count, wanted)',
    '    return "full" if count >= wanted else "room left"',
    "",
  ].join("\n"),
});

/** Runs the packer of the project until there are about so many events; the run's id. */
export async function longRun(server: Server, path: string, events: number): Promise<string> {
  const [project] = await server.ask<readonly { readonly id: string }[]>("GET", "/projects");
  const machine = { project: project?.id, path };
  const inputs = { wanted: Math.ceil(events / EVENTS_A_PART) };
  const start = { id: `long-${events}-${Date.now()}`, machine, inputs };
  const { id } = await server.ask<RunSummary>("POST", "/runs", start);
  for (;;) {
    const { run } = await server.ask<RunNow>("GET", `/runs/${id}`);
    if (run.phase !== "live" && run.phase !== "starting") return id;
    await new Promise((over) => setTimeout(over, 200));
  }
}
