import { describe, expect, it } from "vitest";
import type { MachineStep } from "./generated/protocol.ts";
import { stepRows, stepTree } from "./steps.ts";

/** Steps as short text: `2` is an edit, `3=1` a step that restored the machine of revision 1. */
function tree(text: string, start = 1) {
  const steps = text.split(" ").map((each): MachineStep => {
    const [revision = 0, same] = each.split("=").map(Number);
    const about = { id: each, author: "anna", name: each, at_ms: 0, is_kept: true } as const;
    return { ...about, revision, kind: "edit", ...(same === undefined ? {} : { same_as: same }) };
  });
  return stepTree({ start, steps });
}

function rows(text: string, hasBranches = true): string[] {
  return stepRows(tree(text), hasBranches).map(
    ({ node, place, lane, joins }) =>
      `${node.revision} ${place} ${lane}${joins.map((join) => ` <${join}`).join("")}`,
  );
}

describe("the tree of steps", () => {
  it("is a line while no one goes back", () => {
    expect(rows("2 3")).toEqual(["3 current 0", "2 done 0", "1 done 0"]);
  });

  it("knows what was taken back", () => {
    expect(rows("2 3 4=2")).toEqual(["3 undone 0", "2 current 0", "1 done 0"]);
    expect(rows("2 3 4=2 5=3")).toEqual(["3 current 0", "2 done 0", "1 done 0"]);
  });

  it("branches where someone went back and on", () => {
    expect(rows("2 3 4=2 5")).toEqual(["5 current 0", "3 branch 1", "2 done 0 <1", "1 done 0"]);
    expect(rows("2 3 4=2 5", false)).toEqual(["5 current 0", "2 done 0", "1 done 0"]);
  });

  it("keeps branches of branches apart", () => {
    const text = "2 3 4=2 5 6=1 7";
    expect(rows(text)).toEqual([
      "7 current 0",
      "5 branch 1",
      "3 branch 2",
      "2 branch 1 <2",
      "1 done 0 <1",
    ]);
    expect(tree(text).nodes.get(5)?.parent).toBe(2);
  });

  it("begins somewhere if the oldest steps are gone", () => {
    const { nodes, current } = tree("8 9", 3);
    expect([nodes.get(8)?.parent, nodes.get(9)?.parent, current]).toEqual([null, 8, 9]);
  });
});
