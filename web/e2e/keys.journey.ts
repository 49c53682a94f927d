import { expect } from "vitest";
import { journey } from "./support/journey.ts";

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
    ({ tab }) => tab?.session.machine.children(tab.session.machine.root).length === 4,
    null,
  );
});

journey("who comes from the reference takes its keys", HERE, async ({ app }) => {
  await app.command("Keys…");
  const dialog = app.sheet.getByRole("dialog", { name: "Keys" });
  await dialog.getByLabel("Key map").selectOption("classic");
  await app.sheet.keyboard.press("Escape");
  await app.select("PACKER");
  await app.press("Control+Alt+e");
  await app.settled();
  expect((await app.children()).length).toBe(4);
});

journey(
  "a key whose command cannot be done says why",
  { open: "hierarchy_and_data" },
  async ({ app }) => {
    await app.select("PACKER");
    await app.press("Control+Shift+Alt+u");
    await app.told(
      "Substitute by library…: select a state inside the machine, not the machine itself",
    );
    await app.press("Escape");
    await app.press("Delete");
    await app.told("Delete: select something first");
  },
);
