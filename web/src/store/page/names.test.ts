import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { expect, test } from "vitest";
import { withStateNames } from "./names.ts";
import type { OpenTab } from "./page.ts";

function tab(path: string, name: string): Pick<OpenTab, "session"> {
  const named = (text: string) => text.replaceAll(path, name);
  return { session: { named } as unknown as OpenTab["session"] };
}

test("the machine in front names a state first, then the other machines", () => {
  const [front, other] = [tab("ROOTID/A", "Scan"), tab("ROOTID/A", "Copy of Scan")];
  const third = tab("OTHERS/B", "Weigh");
  expect(withStateNames([other, front, third], front, "ROOTID/A waits for OTHERS/B")).toBe(
    "Scan waits for Weigh",
  );
  expect(withStateNames([], null, "ROOTID/A waits")).toBe("ROOTID/A waits");
});

/** Texts that contain a raw path: in a sentence, or alone in an element. */
const SHOWN_PATH =
  /[a-z,:] \$\{(\w+\.)?[pP]ath\}|\$\{(\w+\.)?[pP]ath\}[,:]? [a-z]|>\{(\w+\.)?path\}<|[a-z] \{(\w+\.)?path\}[,.]/;
/** Paths of folders and libraries are names already, and keys are not shown. */
const NOT_SHOWN = /(file|library)\.path|key=/;

test("paths of states are shown by names: other texts with paths are known", () => {
  const src = join(import.meta.dirname, "../..");
  const files = readdirSync(src, { recursive: true, encoding: "utf8" });
  const sources = files.filter(
    (file) => /\.tsx?$/.test(file) && !/\.test\.|testing|generated/.test(file),
  );
  const showsPath = (line: string) => SHOWN_PATH.test(line) && !NOT_SHOWN.test(line);
  const found = sources.filter((file) =>
    readFileSync(join(src, file), "utf8").split("\n").some(showsPath),
  );
  expect(found.sort()).toEqual([
    // Paths of libraries.
    "panels/planner/findings.tsx",
    "panels/planner/skills.tsx",
    // Refusals: `MachineSession.named` names them where they are shown.
    "plan/legal.ts",
    "plan/transitions.ts",
  ]);
});
