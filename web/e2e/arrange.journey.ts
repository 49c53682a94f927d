import { expect } from "vitest";
import type { App } from "./support/app.ts";
import { journey } from "./support/journey.ts";

const HERE = { open: "hierarchy_and_data" };
const ROOT = "PACKER";
const FULL = "PACKER/ISFULL";
const PART = "PACKER/ONEPAR";
const LABEL = "PACKER/LABELS";

/** Selects several states, one after the other. */
async function selectAll(app: App, ...paths: readonly string[]): Promise<void> {
  const [first = "", ...more] = paths;
  await app.select(first);
  await app.sheet.keyboard.down("Control");
  for (const path of more) await app.click(await app.ground(path));
  await app.sheet.keyboard.up("Control");
  await app.selected(...paths.map((path) => `state:${path}`));
}

journey("states are grouped, and ungrouped again", HERE, async ({ app }) => {
  const before = await app.state(ROOT);
  await selectAll(app, FULL, LABEL);
  await app.press("g");
  await app.settled();
  expect((await app.children()).length).toBe(2);
  const [key = ""] = await app.selection();
  const group = key.replace("state:", "");
  expect(await app.children(group)).toEqual(["Is the box full", "Label the box"]);
  await app.press("u");
  await app.settled();
  expect((await app.children()).length).toBe(3);
  expect((await app.state(ROOT)).transitions?.length).toBe(before.transitions?.length);
});

journey("a state becomes one of another kind", HERE, async ({ app }) => {
  await app.select(PART);
  await app.command("Change kind: Barrier concurrency");
  await app.settled();
  expect((await app.state(PART)).kind).toBe("barrier");
});

journey("another state becomes the one to start with", HERE, async ({ app }) => {
  await app.select(LABEL);
  await app.press("Control+e");
  await app.settled();
  const start = (await app.state(ROOT)).transitions?.find(({ from_state }) => from_state == null);
  expect(start?.to_state).toBe("LABELS");
});

journey("states are lined up and spread out", HERE, async ({ app }) => {
  await selectAll(app, FULL, LABEL, PART);
  await app.command("Align: left edges");
  await app.settled();
  const boxes = await Promise.all([FULL, LABEL, PART].map((path) => app.box(path)));
  expect(new Set(boxes.map(({ x }) => Math.round(x))).size).toBe(1);
  await app.command("Distribute vertically");
  await app.showsText(/Distribute|stay/);
});

journey(
  "a level is laid out by itself, and undo takes it back as one step",
  HERE,
  async ({ app }) => {
    const { layout } = await app.state(PART);
    await app.press("Control+Shift+l");
    await app.until(({ tab }) => (tab?.session.steps.value.steps.length ?? 0) > 0, null);
    await app.settled();
    expect((await app.state(PART)).layout).not.toEqual(layout);
    await app.press("Control+z");
    await app.settled();
    expect((await app.state(PART)).layout).toEqual(layout);
  },
);

journey(
  "a state is substituted by a library, and a library by its content",
  HERE,
  async ({ app }) => {
    await app.select(LABEL);
    await app.command("Substitute by library…");
    const dialog = app.sheet.getByRole("dialog", { name: /Substitute/ });
    await dialog.getByPlaceholder("Find a library").fill("announce");
    await dialog.getByRole("treeitem", { name: "announce" }).click();
    await dialog.getByRole("button", { name: "Substitute" }).click();
    await app.until(({ tab }, path) => tab?.session.machine.state(path)?.kind === "library", LABEL);
    await app.settled();
    expect((await app.state(LABEL)).library).toEqual({ path: "examples/speech", name: "announce" });
    await app.command("Substitute by the library's content: Keep the state's name");
    await app.until(({ tab }, path) => tab?.session.machine.state(path)?.kind !== "library", LABEL);
    expect((await app.state(LABEL)).name).toBe("Label the box");
  },
);
