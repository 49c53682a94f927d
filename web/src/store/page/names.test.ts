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
