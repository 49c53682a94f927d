/** A machine that makes values of two kilobytes: a scan of a laser two and a half times a second, each like the one before. */

import { spawnSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { binary } from "../../e2e/support/places.ts";

const SCAN = `import random
import time

ranges = [2.0 + index / 100 for index in range(250)]


def execute(self, inputs, outputs, gvm):
    for index in range(len(ranges)):
        ranges[index] = max(0.1, ranges[index] + random.gauss(0, 0.02))
    outputs["scan"] = {"frame": "laser", "stamp": round(time.time(), 3), "ranges": [round(one, 3) for one in ranges]}
    return "aborted" if self.preemptive_wait(0.4) else "success"
`;

const USE = `def execute(self, inputs, outputs, gvm):
    return "success"
`;

/** Makes it in a folder that is not there yet. */
export function newValues(folder: string): void {
  const made = spawnSync(binary(), ["new", folder]);
  if (made.status !== 0) throw new Error(`no machine was made: ${made.stderr}`);
  const [root, scan] = [join(folder, "core_data.json"), join(folder, "Greet_GREETS")];
  const use = join(folder, "Say_SAYING");
  // The second state leads back to the first, whose output is the scan; it takes the scan and does nothing with it.
  change(root, (machine) => {
    machine.transitions["3"].to_state = "GREETS";
    machine.transitions["3"].to_outcome = null;
  });
  change(join(use, "core_data.json"), (state) => {
    state.input_data_ports["0"].data_type = { __type__: "__builtin__.dict" };
    state.input_data_ports["0"].default_value = null;
  });
  writeFileSync(join(use, "script.py"), USE);
  change(join(scan, "core_data.json"), (state) => {
    const output = state.output_data_ports["1"];
    output.name = "scan";
    output.data_type = { __type__: "__builtin__.dict" };
    output.default_value = null;
  });
  writeFileSync(join(scan, "script.py"), SCAN);
}

// biome-ignore lint/suspicious/noExplicitAny: the files of a machine have no types here
function change(file: string, how: (content: any) => void): void {
  const content = JSON.parse(readFileSync(file, "utf8"));
  how(content);
  writeFileSync(file, JSON.stringify(content, null, 4));
}
