import { expect } from "vitest";
import { journey } from "./house/journey.ts";

const HERE = { open: "hierarchy_and_data" };
const FULL = "PACKER/ISFULL";

journey("a command gets another key", HERE, async ({ app }) => {
  await app.command("Keys…");
  const dialog = app.sheet.getByRole("dialog", { name: "Keys" });
  await dialog.getByRole("searchbox", { name: "Find" }).fill("Duplicate");
  await dialog.getByRole("button", { name: "Add keys to Duplicate" }).click();
  await app.sheet.keyboard.press("Alt+j");
  await app.sheet.keyboard.press("Escape");
  await app.select(FULL);
  await app.press("Alt+j");
  await app.until(
    ({ tab }) => tab?.room.machine.children(tab.room.machine.root).length === 4,
    null,
  );
});

journey("who comes from the reference takes its keys", HERE, async ({ app }) => {
  await app.command("Keys…");
  const dialog = app.sheet.getByRole("dialog", { name: "Keys" });
  await dialog.getByLabel("Map").selectOption("classic");
  await app.sheet.keyboard.press("Escape");
  await app.select("PACKER");
  await app.press("Control+Alt+e");
  await app.settled();
  expect((await app.children()).length).toBe(4);
});
