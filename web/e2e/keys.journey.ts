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
    await app.showsText(
      "Substitute by library…: select a state inside the machine, not the machine itself",
    );
    await app.press("Escape");
    await app.press("Delete");
    await app.showsText("Delete: select something first");
  },
);

journey("a notice lies on the canvas and covers no panel", HERE, async ({ app }) => {
  await app.select("PACKER");
  await app.press("Control+Shift+Alt+u");
  const toast = app.sheet.locator(".toast");
  const canvas = app.sheet.locator(".canvas-place");
  const [on, around] = [await toast.boundingBox(), await canvas.boundingBox()];
  expect(on && around && on.y + on.height <= around.y + around.height).toBe(true);
  expect(on && around && on.x >= around.x && on.x + on.width <= around.x + around.width).toBe(true);
});

journey("Enter of an input method is not the page's", HERE, async ({ app }) => {
  await app.select(FULL);
  await app.press("F2");
  const name = app.sheet.locator("input:focus");
  await name.waitFor();
  const composition = await app.sheet.context().newCDPSession(app.sheet);
  await composition.send("Input.imeSetComposition", {
    text: "にほ",
    selectionStart: 2,
    selectionEnd: 2,
  });
  const written = await name.inputValue();
  await name.evaluate((field) => {
    const how = { key: "Enter", isComposing: true, bubbles: true, cancelable: true };
    field.dispatchEvent(new KeyboardEvent("keydown", how));
  });
  expect(await name.inputValue()).toBe(written);
  await composition.send("Input.insertText", { text: "日本" });
  await app.sheet.keyboard.press("Enter");
  await app.settled();
  expect((await app.state(FULL)).name).toContain("日本");
});

journey("letters of the canvas work on a layout of another script", HERE, async ({ app }) => {
  await app.canvas.evaluate((canvas) => {
    const t = { key: "е", code: "KeyT", bubbles: true, cancelable: true };
    canvas.dispatchEvent(new KeyboardEvent("keydown", t));
  });
  await app.until(({ tab }) => tab?.view.modes.value.transitions === false, null);
});
