import { describe, expect, it } from "vitest";
import { memoryStore } from "../local_store.ts";
import { type KeptTabs, keepSession, readSession, restoreView } from "./session.ts";
import { FIRST_CAMERA, MODES, newView } from "./view.ts";

const FILE = { project: "p", path: "machine" };
const SESSION: KeptTabs = {
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
    const localStore = memoryStore();
    keepSession(localStore, SESSION);
    expect(readSession(localStore)).toEqual(SESSION);
    const view = newView();
    const [tab] = SESSION.tabs;
    if (tab) restoreView(view, tab);
    expect([...view.selection.value]).toEqual(["state:R/A"]);
    expect(view.contents.value.get("R/L")).toBe(true);
    expect(view.modes.value.grid).toBe(true);
  });

  it("lets the canvas choose where to look if no one has chosen", () => {
    const localStore = memoryStore();
    localStore.put("rafcon.session", { tabs: [{ file: FILE, camera: { x: 0, y: 0, scale: 1 } }] });
    expect(readSession(localStore)?.tabs[0]?.camera).toBe(FIRST_CAMERA);
  });

  it("is none if nothing was kept, or nothing that can be read", () => {
    const localStore = memoryStore();
    expect(readSession(localStore)).toBeNull();
    for (const kept of ["text", { tabs: 3 }, []]) {
      localStore.put("rafcon.session", kept);
      expect(readSession(localStore)).toBeNull();
    }
    localStore.put("rafcon.session", { tabs: [{ camera: "none" }, { file: FILE, camera: {} }] });
    expect(readSession(localStore)?.tabs.map(({ file }) => file)).toEqual([FILE]);
  });
});
