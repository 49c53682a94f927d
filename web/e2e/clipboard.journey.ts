import { expect } from "vitest";
import { journey } from "./house/journey.ts";
import { examples } from "./house/places.ts";

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
    ({ tab }) => tab?.room.machine.children(tab.room.machine.root).length === 4,
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
      ({ tab }) => tab?.room.machine.children(tab.room.machine.root).length === 2,
      null,
    );
    await app.click(await app.spot(ROOT, 100, 300));
    await app.press("Control+v");
    await app.until(
      ({ tab }) => tab?.room.machine.children(tab.room.machine.root).length === 3,
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
    ({ tab }) => tab?.room.machine.children(tab.room.machine.root).length === 5,
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
    (at) => at.tab?.room.machine.children(at.tab.room.machine.root).length === 5,
    null,
  );
  expect(await other.children()).toContain("Pack one part");
});

journey("a state is duplicated", HERE, async ({ app }) => {
  await app.select(FULL);
  await app.press("Control+d");
  await app.until(
    ({ tab }) => tab?.room.machine.children(tab.room.machine.root).length === 4,
    null,
  );
});
