import { expect } from "vitest";
import { journey } from "./support/journey.ts";

const HERE = { open: "hierarchy_and_data" };
const ROOT = "PACKER";
const FULL = "PACKER/ISFULL";
const PART = "PACKER/ONEPAR";
const PICK = "PACKER/ONEPAR/PICKIT";
const LABEL = "PACKER/LABELS";

journey("a machine is opened and stands where its file says", HERE, async ({ app }) => {
  expect(await app.children()).toEqual(["Is the box full", "Label the box", "Pack one part"]);
  const [root, full] = [await app.box(ROOT), await app.box(FULL)];
  expect(full.x - root.x).toBeCloseTo((50 / 680) * root.width, 3);
  await app.select(FULL);
});

journey("a state is moved by dragging, and undo brings it back", HERE, async ({ app }) => {
  const before = await app.box(FULL);
  const from = await app.ground(FULL);
  await app.drag(from, { x: from.x + 40, y: from.y + 90 });
  expect(await app.lastStep()).toBe("Move Is the box full");
  expect((await app.box(FULL)).y - before.y).toBeGreaterThan(60);
  await app.press("Control+z");
  await app.settled();
  expect((await app.box(FULL)).y).toBeCloseTo(before.y, 3);
});

journey("states are added by key, by menu and from the bar", HERE, async ({ app }) => {
  const add = app.sheet.getByRole("toolbar", { name: "Add states" });
  const place = async (x: number, y: number) => {
    await app.click(await app.spot(ROOT, x, y));
    await app.selected(`state:${ROOT}`);
  };
  await place(60, 200);
  await app.press("e");
  await place(60, 330);
  await app.menu("Insert", "Hierarchy");
  await place(600, 330);
  await add.getByRole("button", { name: "Add barrier" }).click();
  await app.settled();
  expect((await app.children()).length).toBe(6);
});

journey("a state is dragged from the bar to its place", HERE, async ({ app }) => {
  const add = app.sheet.getByRole("button", { name: "Add preemptive" });
  const box = await add.boundingBox();
  if (!box) throw new Error("the bar is not there");
  await app.drag({ x: box.x + 20, y: box.y + 10 }, await app.spot(ROOT, 100, 250));
  await app.settled();
  expect((await app.children()).length).toBe(4);
  const [key = ""] = await app.selection();
  expect((await app.state(key.replace("state:", ""))).kind).toBe("preemptive");
});

journey("what is selected is deleted with its connections", HERE, async ({ app }) => {
  await app.select(LABEL);
  await app.press("Delete");
  await app.settled();
  expect(await app.children()).toEqual(["Is the box full", "Pack one part"]);
  const { transitions } = await app.state(ROOT);
  expect(transitions?.some(({ to_state }) => to_state === "LABELS")).toBe(false);
});

journey("an outcome is connected by dragging it to where it leads", HERE, async ({ app }) => {
  await app.select(LABEL);
  await app.press("Delete");
  await app.settled();
  const before = (await app.state(ROOT)).transitions?.length ?? 0;
  const [full, success] = [
    await app.port(FULL, "outcome", "full"),
    await app.port(ROOT, "outcome", "success"),
  ];
  await app.drag(full, success);
  await app.settled();
  expect((await app.state(ROOT)).transitions?.length).toBe(before + 1);
});

journey(
  "a connection that cannot be is refused at the pointer, and nothing happens",
  HERE,
  async ({ app }) => {
    const before = await app.state(ROOT);
    await app.drag(
      await app.port(FULL, "outcome", "full"),
      await app.port(PART, "input", "count"),
      () => app.showsText(/transition|outcome|data port/),
    );
    await app.settled();
    expect((await app.state(ROOT)).transitions).toEqual(before.transitions);
    expect((await app.state(ROOT)).data_flows).toEqual(before.data_flows);
  },
);

journey(
  "a data flow that is dropped on a state makes the port that it needs",
  HERE,
  async ({ app }) => {
    await app.drag(await app.port(ROOT, "input", "wanted"), await app.ground(LABEL));
    await app.settled();
    const inputs = (await app.state(LABEL)).inputs?.map(({ name }) => name);
    expect(inputs).toContain("wanted");
  },
);

journey(
  "a data flow over several levels makes the ports between in one step",
  HERE,
  async ({ app }) => {
    const before = (await app.state(PART)).inputs?.length ?? 0;
    await app.drag(
      await app.port(ROOT, "input", "wanted"),
      await app.port(PICK, "input", "number"),
    );
    await app.settled();
    expect((await app.state(PART)).inputs?.length).toBe(before + 1);
    await app.press("Control+z");
    await app.settled();
    expect((await app.state(PART)).inputs?.length).toBe(before);
  },
);

journey("the end of a transition is dragged to another state", HERE, async ({ app }) => {
  const transitions = (await app.state(ROOT)).transitions ?? [];
  const id = transitions.find(({ to_state }) => to_state === "LABELS")?.id;
  await app.sheet.evaluate(
    ([path, number]) =>
      window.__rafcon.context().canvas?.reveal({ kind: "transition", path, id: number }),
    [ROOT, id ?? 0] as const,
  );
  const at = await app.port(LABEL, "income");
  await app.click({ x: at.x - 14, y: at.y });
  await app.selected(`transition:${ROOT}:${id}`);
  await app.drag(at, await app.port(PART, "income"));
  await app.settled();
  const after = (await app.state(ROOT)).transitions?.find((each) => each.id === id);
  expect(after?.to_state).toBe("ONEPAR");
});

journey(
  "a state that is dropped on a transition stands between its ends",
  HERE,
  async ({ app }) => {
    await app.select(ROOT);
    await app.press("e");
    await app.settled();
    const [key = ""] = await app.selection();
    const path = key.replace("state:", "");
    const [success, packed] = [await app.port(LABEL, "outcome", "success"), await app.box(ROOT)];
    await app.drag(await app.ground(path), { x: success.x + packed.width * 0.12, y: success.y });
    await app.settled();
    const { transitions = [] } = await app.state(ROOT);
    const id = path.split("/").at(-1);
    expect(transitions?.filter(({ from_state }) => from_state === id).length).toBe(1);
    expect(transitions?.filter(({ to_state }) => to_state === id).length).toBe(1);
  },
);

journey("states are taken by the rubber band", HERE, async ({ app }) => {
  await app.drag(await app.spot(ROOT, 190, 250), await app.spot(ROOT, 400, 370));
  await app.selected(`state:${LABEL}`);
});

journey("a state is resized, without its content and with it", HERE, async ({ app }) => {
  const corner = async () => app.spot(PART, 400, 182);
  const inner = await app.box(PICK);
  await app.select(PART);
  const from = await corner();
  await app.drag(from, { x: from.x - 20, y: from.y + 25 });
  await app.settled();
  expect((await app.box(PICK)).width).toBeCloseTo(inner.width, 3);
  await app.press("Control+z");
  await app.settled();
  await app.sheet.keyboard.down("Control");
  await app.drag(from, { x: from.x - 60, y: from.y - 27 });
  await app.sheet.keyboard.up("Control");
  await app.settled();
  expect((await app.box(PICK)).width).toBeLessThan(inner.width - 5);
});

journey("a state is dragged into another container", HERE, async ({ app }) => {
  await app.drag(await app.ground(LABEL), await app.spot(PART, 375, 155));
  await app.settled();
  expect(await app.children(PART)).toContain("Label the box");
});

journey("a copy is dragged off with Alt", HERE, async ({ app }) => {
  const from = await app.ground(FULL);
  await app.sheet.keyboard.down("Alt");
  await app.drag(from, { x: from.x, y: from.y + 170 });
  await app.sheet.keyboard.up("Alt");
  await app.settled();
  expect((await app.children()).length).toBe(4);
});

journey("Escape gives up a gesture before it does anything", HERE, async ({ app }) => {
  const before = await app.box(FULL);
  const from = await app.ground(FULL);
  await app.drag(from, { x: from.x + 50, y: from.y + 50 }, () =>
    app.sheet.keyboard.press("Escape"),
  );
  await app.settled();
  expect(await app.box(FULL)).toEqual(before);
});

journey("a state is put into the selected transition by the menu", HERE, async ({ app }) => {
  const root = await app.state("PACKER");
  const line = root.transitions?.find(({ from_state }) => from_state === "ISFULL");
  await app.sheet.evaluate((id) => {
    const tab = window.__rafcon.context().tab;
    if (tab) tab.view.selection.value = new Set([`transition:PACKER:${id}`]);
  }, line?.id ?? -1);
  await app.sheet.getByRole("menubar").getByRole("menuitem", { name: "Insert" }).click();
  await app.sheet.getByRole("menuitem", { name: "Insert into transition" }).click();
  await app.sheet.getByRole("menuitem", { name: "Hierarchy" }).last().click();
  await app.until(
    ({ tab }) => tab?.session.machine.children(tab.session.machine.root).length === 4,
    null,
  );
  expect(await app.lastStep()).toBe("Insert state into transition");
});
