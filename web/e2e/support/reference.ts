/** The reference, as a black box: the machines that it ships, and its core, which loads what was saved here. */

import { spawnSync } from "node:child_process";
import { existsSync, mkdtempSync, readdirSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, dirname, join } from "node:path";
import { REPOSITORY } from "./places.ts";

function python(): string {
  const named = process.env["RAFCON_REFERENCE_PYTHON"];
  return named ?? join(REPOSITORY, "target/reference-venv/bin/python");
}

/** Where the PyPI package `rafcon` keeps its machines and libraries; `cargo xtask test` installs it. */
export function share(): string {
  const site = "import sysconfig; print(sysconfig.get_path('purelib'))";
  const { stdout } = spawnSync(python(), ["-c", site], { encoding: "utf8" });
  const named = process.env["RAFCON_REFERENCE_SHARE"];
  const found = named ?? join((stdout ?? "").trim(), "rafcon/share/rafcon");
  if (existsSync(found)) return found;
  throw new Error("the reference is not installed: run `cargo xtask test --only e2e`");
}

/** Its example machines and libraries: folders by their path below `share`. */
export function shipped(): readonly string[] {
  const files = readdirSync(share(), { recursive: true, encoding: "utf8" });
  return files
    .filter((file) => basename(file) === "statemachine.json")
    .map(dirname)
    .sort();
}

/** Library roots as the reference's own configuration names them. */
export function shippedLibraries(): Record<string, string> {
  return {
    generic: join(share(), "libraries/generic"),
    tutorials: join(share(), "examples/tutorials"),
  };
}

/** What the core knows of a machine that it has loaded. */
export interface Loaded {
  readonly states: number;
  /** Where the layout puts each state, by path: what stands in the folder where the core found the state. */
  readonly positions: Readonly<Record<string, readonly [number, number] | null>>;
}

const PROGRAM = `
import json, os, sys
os.environ["HOME"] = sys.argv[1]
from rafcon.core.config import global_config
from rafcon.core.singleton import library_manager
from rafcon.core.storage import storage
libraries = json.loads(sys.argv[2])
with open(os.path.join(sys.argv[1], "config.yaml"), "w") as file:
    file.write("TYPE: SM_CONFIG\\nLIBRARY_PATHS:\\n")
    for name, folder in libraries.items():
        file.write("    {}: {}\\n".format(name, folder))
global_config.load(config_file="config.yaml", path=sys.argv[1])
library_manager.show_dialog = False
library_manager.initialize()
loaded = {}
for folder in sys.argv[3:]:
    machine = storage.load_state_machine_from_path(folder)
    positions = {}
    def look(state, path):
        layout = os.path.join(state.file_system_path, "meta_data.json")
        if os.path.exists(layout):
            drawn = json.load(open(layout)).get("gui", {}).get("editor_gaphas", {})
            positions[path] = drawn.get("rel_pos", {}).get("items")
        children = getattr(state, "states", {})
        return 1 + sum(look(child, path + "/" + child.state_id) for child in children.values())
    root = machine.root_state
    loaded[folder] = {"states": look(root, root.state_id), "positions": positions}
sys.stdout.flush()
print("\\n" + json.dumps(loaded))
`;

/** Loads machines in the reference's own core. */
export function loadInReference(
  folders: readonly string[],
  libraries: Readonly<Record<string, string>>,
): Readonly<Record<string, Loaded>> {
  const home = mkdtempSync(join(tmpdir(), "rafcon-reference-"));
  const words = ["-c", PROGRAM, home, JSON.stringify(libraries), ...folders];
  const { status, stdout, stderr } = spawnSync(python(), words, { encoding: "utf8" });
  if (status !== 0) throw new Error(`the reference cannot load them: ${stdout}${stderr}`);
  return JSON.parse(stdout.trimEnd().split("\n").at(-1) ?? "") as Record<string, Loaded>;
}

/** The name of a machine's folder in a project, from its path below `share`. */
export function asName(path: string): string {
  return path.replaceAll("/", "-");
}
