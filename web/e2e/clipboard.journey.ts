import { expect } from "vitest";
import { journey } from "./support/journey.ts";
import { examples } from "./support/places.ts";

const HERE = { open: "hierarchy_and_data", machines: examples("error_recovery") };
const ROOT = "PACKER";
const FULL = "PACKER/ISFULL";
const PART = "PACKER/ONEPAR";

journey("a state is copied with all inside, and pasted", HERE, async ({ app }) => {
  await app.select(PART);
  await app.press("Control+c");
  await app.click(await app.spot(ROOT, 100, 300));
  await app.press("Control+v");
  await app.until(
    ({ tab }) => tab?.session.machine.children(tab.session.machine.root).length === 4,
    null,
  );
  await app.settled();
  const [key = ""] = await app.selection();
  expect(await app.children(key.replace("state:", ""))).toEqual([
    "Pick from the belt",
    "Place in the box",
  ]);
});

journey(
  "what is cut goes with its connections, and comes back where it is pasted",
  HERE,
  async ({ app }) => {
    await app.select(FULL);
    await app.press("Control+x");
    await app.until(
      ({ tab }) => tab?.session.machine.children(tab.session.machine.root).length === 2,
      null,
    );
    await app.click(await app.spot(ROOT, 100, 300));
    await app.press("Control+v");
    await app.until(
      ({ tab }) => tab?.session.machine.children(tab.session.machine.root).length === 3,
      null,
    );
    expect(await app.children()).toContain("Is the box full");
  },
);

journey("a copy is pasted into another machine", HERE, async ({ app }) => {
  await app.select(PART);
  await app.press("Control+c");
  await app.open("error_recovery");
  await app.press("Control+v");
  await app.until(
    ({ tab }) => tab?.session.machine.children(tab.session.machine.root).length === 5,
    null,
  );
  expect(await app.children()).toContain("Pack one part");
});

journey("a copy is pasted in another tab of the browser", HERE, async ({ app, tab }) => {
  await app.select(PART);
  await app.press("Control+c");
  const other = await tab(app);
  await other.open("error_recovery");
  await other.sheet.bringToFront();
  await other.press("Control+v");
  await other.until(
    (at) => at.tab?.session.machine.children(at.tab.session.machine.root).length === 5,
    null,
  );
  expect(await other.children()).toContain("Pack one part");
});

journey("a state is duplicated", HERE, async ({ app }) => {
  await app.select(FULL);
  await app.press("Control+d");
  await app.until(
    ({ tab }) => tab?.session.machine.children(tab.session.machine.root).length === 4,
    null,
  );
});

journey(
  "rows of ports are copied, and pasted as another kind in another state",
  HERE,
  async ({ app }) => {
    await app.select(PART);
    const { sheet } = app;
    const state = await app.state(PART);
    const [first] = state.inputs ?? [];
    const table = sheet.getByRole("grid", { name: `Inputs of ${state.name}` });
    await table.getByRole("gridcell", { name: first?.name ?? "", exact: true }).click();
    await sheet.keyboard.press("Shift+End");
    await sheet.keyboard.press("Control+c");
    await app.select(ROOT);
    await sheet.getByRole("button", { name: "Paste as scoped variable" }).click();
    const count = (state.inputs ?? []).length;
    const before = (await app.state(ROOT)).scoped_variables ?? [];
    await app.until(
      ({ tab }, [path, many]) =>
        (tab?.session.machine.state(String(path))?.scoped_variables ?? []).length >= Number(many),
      [ROOT, count],
    );
    await app.settled();
    const after = (await app.state(ROOT)).scoped_variables ?? [];
    expect(after.length).toBeGreaterThanOrEqual(Math.max(before.length, count));
    expect(await app.lastStep()).toMatch(/^Paste /);
  },
);

journey(
  "an outcome is copied on the canvas and pasted in another machine",
  HERE,
  async ({ app }) => {
    await app.select(PART);
    const name = (await app.state(PART)).outcomes?.find(({ id }) => id >= 0)?.name ?? "";
    await app.click(await app.port(PART, "outcome", name));
    await app.selected(`outcome:${PART}:0`);
    await app.press("Control+c");
    await app.open("error_recovery");
    const root = await app.sheet.evaluate(
      () => window.__rafcon.context().tab?.session.machine.root ?? "",
    );
    await app.select(root);
    await app.press("Control+v");
    await app.until(
      ({ tab }, path) =>
        tab?.session.steps.value.steps.at(-1)?.name.startsWith("Paste") === true && path !== "",
      root,
    );
    const names = (await app.state(root)).outcomes?.map((outcome) => outcome.name) ?? [];
    expect(names.filter((each) => each.startsWith(name)).length).toBeGreaterThan(0);
  },
);

journey("a duplicate keeps the way of a connection among its states", HERE, async ({ app }) => {
  const [state] = [await app.state(ROOT)];
  const line = state.transitions?.find(
    ({ from_state, to_state }) => from_state && to_state !== "PACKER",
  );
  await app.sheet.evaluate(
    ([path, id]) =>
      window.__rafcon.context().tab?.session.edit("Bend", {
        edit: "set_waypoints",
        path: String(path),
        element: { transition: Number(id) },
        waypoints: [[150, 150]],
      }),
    [ROOT, line?.id ?? -1],
  );
  await app.settled();
  await app.press("Control+a");
  await app.press("Control+d");
  await app.until(
    ({ tab }) => tab?.session.machine.children(tab.session.machine.root).length === 6,
    null,
  );
  await app.settled();
  const layout: object = (await app.state(ROOT)).layout ?? {};
  const bent = Object.entries(layout).filter(
    ([key, entry]) => /^transition/.test(key) && JSON.stringify(entry).includes('"waypoints"'),
  );
  expect(bent.length).toBeGreaterThanOrEqual(2);
  expect(await app.lastStep()).toMatch(/^Duplicate/);
});
