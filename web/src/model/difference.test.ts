import { describe, expect, it } from "vitest";
import { differences, marksOf } from "./difference.ts";
import type { Document, StateDocument } from "./generated/protocol.ts";
import { machineOf } from "./plain_machine.ts";
import { sketch } from "./testing/sketch.ts";

const TEXT = `
  R "Root" hierarchy 0 0 400 300 outcome done input speed:int=3
    A "Scan" execution 20 20 80 60 outcome ok output pose:list
    B "Grip" hierarchy 200 20 80 60 outcome ok input pose:list
      C "Close" execution outcome ok
    R > A
    A.ok > B
    B.ok > R.done
    A.pose >> B.pose`;

/** Differences as short text. */
function compared(text: string, change: (state: StateDocument) => StateDocument = (s) => s) {
  const old = machineOf(sketch(TEXT));
  const document = sketch(text);
  const states = document.states.map(change);
  return differences(old, machineOf({ ...document, states } as Document)).map((each) => {
    const fields = each.fields.map(({ field, old, now }) => `${field} ${old} → ${now}`);
    const count = each.inside > 0 ? ` +${each.inside}` : "";
    const layout = each.isLayout ? " layout" : "";
    return `${each.kind} ${each.element.kind} ${each.name}${count}${layout} ${fields.join(", ")}`.trim();
  });
}

describe("differences of two machines", () => {
  it("are none between a machine and itself", () => {
    expect(compared(TEXT)).toEqual([]);
  });

  it("name states that came and went, and connections", () => {
    const text = TEXT.replace('C "Close"', 'D "Open"').replace("B.ok > R.done", "B.ok > A");
    expect(compared(text)).toEqual([
      "changed transition Grip.ok → Scan way Grip.ok → Root.done → Grip.ok → Scan",
      "removed state Close",
      "added state Open",
    ]);
  });

  it("say what else is another one", () => {
    const text = TEXT.replace("speed:int=3", "speed:float=4").replace('"Scan"', '"Look"');
    expect(compared(text)).toEqual([
      "changed input speed type int → float, default 3 → 4",
      "changed state Look name Scan → Look",
    ]);
  });

  it("know what moved, and what got another id", () => {
    const moved = `
      R "Root" hierarchy 0 0 400 300 outcome done input speed:int=3
        B "Grip" hierarchy 200 20 80 60 outcome ok input pose:list
          A "Scan" execution 20 20 80 60 outcome ok output pose:list
          C "Close" execution outcome ok
        B.ok > R.done`;
    expect(compared(moved)).toContain("changed state Scan container R → R/B");
    const renamed = TEXT.replaceAll(/\bB\b/g, "Z");
    expect(compared(renamed)).toEqual(["changed state Grip id B → Z"]);
  });

  it("keep what only stands elsewhere apart", () => {
    expect(compared(TEXT.replace("20 20 80 60", "40 20 80 60"))).toEqual([
      "changed state Scan layout",
    ]);
  });

  it("count what comes and goes inside", () => {
    const text = TEXT.replace(/ {4}B "Grip"[\s\S]*?outcome ok\n(?= {4}R)/, "")
      .replace("A.ok > B\n", "A.ok > R.done\n")
      .replace(/ {4}B\.ok.*\n/, "")
      .replace(/ {4}A\.pose.*/, "");
    expect(compared(text)).toContain("removed state Grip +1");
  });

  it("mark what is there", () => {
    const old = machineOf(sketch(TEXT.replace('      C "Close" execution outcome ok\n', "")));
    const now = machineOf(sketch(TEXT));
    expect([...marksOf(differences(old, now), now)]).toEqual([["state:R/B/C", "added"]]);
  });

  it("compare texts line by line where they are texts", () => {
    const found = differences(
      machineOf(sketch(TEXT)),
      machineOf({
        ...sketch(TEXT),
        states: sketch(TEXT).states.map((state) =>
          state.path === "R/A" ? { ...state, script: "a\nb" } : state,
        ),
      }),
    );
    expect(found[0]?.fields).toEqual([{ field: "script", old: "", now: "a\nb", isText: true }]);
  });
});
