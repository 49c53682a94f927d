/** The gate of the link with real programs in real time: `cargo xtask spacebotcamp --real`. Prints a table, or with `--json` one JSON
 * object a line; fails if a bar is missed. */

import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { parseArgs } from "node:util";
import { Camp, newMission } from "./link/camp.ts";
import { farPageLive } from "./link/far.ts";
import { overLinks } from "./link/links.ts";
import { figures, printed } from "./link/measures.ts";
import { beOperator } from "./link/operator.ts";
import { Scenario } from "./link/scenario.ts";

/** With this pace of entries and ends of states, about ten events happen in a second, with all that comes beside them. */
const RATE = 9;

/** The rate at which a page far away is opened. */
const SLOW_BITS = 64_000;

async function main(): Promise<void> {
  const { values } = parseArgs({
    options: {
      minutes: { type: "string", default: "60" },
      stations: { type: "string", default: "3" },
      far: { type: "boolean", default: false },
      links: { type: "string" },
      json: { type: "boolean", default: false },
    },
  });
  if (values.far) {
    const took = await farPageLive(SLOW_BITS, RATE);
    const value = took === null ? Number.POSITIVE_INFINITY : took / 1_000;
    printed([{ name: "page_live_far_s", value, unit: "s", bar: null }], values.json);
    return;
  }
  if (values.links !== undefined) {
    const found = await overLinks(values.links);
    if (!printed(found, values.json)) process.exitCode = 1;
    return;
  }
  const minutes = Number(values.minutes);
  if (!(minutes >= 5)) throw new Error("--minutes: a number of at least 5");
  const camp = await Camp.pitch({
    hasSeveral: values.stations !== "1",
    profile: "delay-2s",
    path: [],
    machine: (folder) => newMission(folder, RATE),
    inputs: { time_scale: 0 },
  });
  try {
    const hour = await new Scenario(camp, { minutes }).play();
    writeFileSync(join(camp.folder, "hour.json"), JSON.stringify(hour));
    if (!printed(figures(hour), values.json)) process.exitCode = 1;
  } catch (error) {
    process.exitCode = 1;
    throw error;
  } finally {
    await camp.strike();
  }
}

const [, , first, second] = process.argv;
if (first === "operator" && second) beOperator(second);
else {
  await main();
  // Whatever still hangs.
  process.exit();
}
