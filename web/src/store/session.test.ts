import { describe, expect, it } from "vitest";
import { keepSession, readSession, restoreView, type Session } from "./session.ts";
import { memoryShed } from "./shed.ts";
import { FIRST_CAMERA, MODES, newView } from "./view.ts";

const FILE = { project: "p", path: "machine" };
const SESSION: Session = {
  tabs: [
    {
      file: FILE,
      run: "machine-1",
      camera: { x: 1, y: 2, scale: 3 },
      selection: ["state:R/A"],
      modes: { ...MODES, grid: true },
      contents: [["R/L", true]],
    },
  ],
  active: 0,
};

describe("a session", () => {
  it("comes back as it was kept", () => {
    const shed = memoryShed();
    keepSession(shed, SESSION);
    expect(readSession(shed)).toEqual(SESSION);
    const view = newView();
    const [tab] = SESSION.tabs;
    if (tab) restoreView(view, tab);
    expect([...view.selection.value]).toEqual(["state:R/A"]);
    expect(view.contents.value.get("R/L")).toBe(true);
    expect(view.modes.value.grid).toBe(true);
  });

  it("lets the canvas choose where to look if nobody has chosen", () => {
    const shed = memoryShed();
    shed.put("rafcon.session", { tabs: [{ file: FILE, camera: { x: 0, y: 0, scale: 1 } }] });
    expect(readSession(shed)?.tabs[0]?.camera).toBe(FIRST_CAMERA);
  });

  it("is none if nothing was kept, or nothing that can be read", () => {
    const shed = memoryShed();
    expect(readSession(shed)).toBeNull();
    for (const kept of ["text", { tabs: 3 }, []]) {
      shed.put("rafcon.session", kept);
      expect(readSession(shed)).toBeNull();
    }
    shed.put("rafcon.session", { tabs: [{ camera: "none" }, { file: FILE, camera: {} }] });
    expect(readSession(shed)?.tabs.map(({ file }) => file)).toEqual([FILE]);
  });
});
