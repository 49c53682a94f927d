/** Where the programs and folders are that journeys and benches need; what the environment does not say is found beside the
 * repository's sources. */

import { cpSync, existsSync, mkdirSync, mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";

/** The repository: programs start in `web`. */
export const REPOSITORY = resolve(process.cwd(), "..");

export const EXAMPLES = join(REPOSITORY, "examples");

/** Where pictures of failed journeys and other results go. */
export const RESULTS = join(REPOSITORY, "target", "e2e");

/** The program under test. */
export function binary(): string {
  const found = process.env["RAFCON_BINARY"] ?? join(REPOSITORY, "target/debug/rafcon");
  if (!existsSync(found)) throw new Error(`there is no ${found}: run \`cargo build\` first`);
  return found;
}

/** A folder of its own for one server: projects, state and runs. */
export interface Place {
  readonly folder: string;
  /** The folder that is served, named `missions`. */
  readonly project: string;
  /** Library roots by name: copies in the project, so that they can be edited too. */
  readonly libraries: Readonly<Record<string, string>>;
  /** What the server finds on its path beside what is there for everybody. */
  readonly programs?: readonly string[];
}

const LIBRARIES = { examples: join(EXAMPLES, "libraries") };

/** A new place with copies of machines, by the name that they get, and of libraries. */
export function newPlace(
  machines: Readonly<Record<string, string>>,
  roots: Readonly<Record<string, string>> = LIBRARIES,
): Place {
  const folder = mkdtempSync(join(tmpdir(), "rafcon-e2e-"));
  const project = join(folder, "missions");
  mkdirSync(project);
  for (const [name, from] of Object.entries(machines)) {
    cpSync(from, join(project, name), { recursive: true });
  }
  const libraries: Record<string, string> = {};
  for (const [name, from] of Object.entries(roots)) {
    const copy = join(project, "libraries", name);
    cpSync(from, copy, { recursive: true });
    libraries[name] = copy;
  }
  writeFileSync(join(folder, "config.yaml"), "TYPE: SM_CONFIG\nLIBRARY_PATHS: {}\n");
  return { folder, project, libraries };
}

/** The examples that a name stands for. */
export function examples(...names: readonly string[]): Record<string, string> {
  return Object.fromEntries(names.map((name) => [name, join(EXAMPLES, name)]));
}
