import { expect } from "vitest";
import type { App } from "./support/app.ts";
import { journey } from "./support/journey.ts";

const HERE = { open: "hierarchy_and_data" };
const LABEL = "PACKER/LABELS";

function editorOf(app: App) {
  return app.sheet.getByRole("textbox", { name: "Script of Label the box" });
}

async function script(app: App, path = LABEL): Promise<string> {
  return (await app.state(path)).script ?? "";
}

/** Writes a line at the beginning of the script, without applying it. */
async function write(app: App, line: string): Promise<void> {
  await editorOf(app).click();
  await app.sheet.keyboard.press("Control+Home");
  await app.sheet.keyboard.type(`${line}\n`);
  await app.sheet.getByText("Not applied yet").waitFor();
}

journey("a renamed port is renamed in the script, once that was seen", HERE, async ({ app }) => {
  await app.select(LABEL);
  const table = app.sheet.getByRole("grid", { name: "Inputs of Label the box" });
  await table.getByRole("gridcell", { name: "weight_g", exact: true }).dblclick();
  await app.sheet.keyboard.type("grams");
  await app.sheet.keyboard.press("Enter");
  const asked = app.sheet.getByRole("dialog", { name: "Rename weight_g to grams" });
  expect(await asked.getByText("inputs['grams']").count()).toBe(1);
  await asked.getByRole("button", { name: "Name and script" }).click();
  await app.settled();
  expect(await script(app)).toContain("inputs['grams'] / 1000");
  expect((await app.state(LABEL)).inputs?.map(({ name }) => name)).toContain("grams");
  await app.press("Control+z");
  await app.settled();
  expect(await script(app)).toContain("inputs['weight_g'] / 1000");
});

journey("Tab leads from cell to cell", HERE, async ({ app }) => {
  await app.select(LABEL);
  const table = app.sheet.getByRole("grid", { name: "Inputs of Label the box" });
  await table.getByRole("gridcell", { name: "count", exact: true }).dblclick();
  await app.sheet.keyboard.press("Tab");
  await app.sheet.keyboard.press("Control+a");
  await app.sheet.keyboard.type("object");
  await app.sheet.keyboard.press("Tab");
  await app.sheet.keyboard.press("Control+a");
  await app.sheet.keyboard.type("1.5");
  await app.sheet.keyboard.press("Enter");
  await app.until(({ tab }, path) => {
    const port = tab?.session.machine.state(path)?.inputs?.find(({ name }) => name === "count");
    return port?.data_type === "object" && port.default === 1.5;
  }, LABEL);
});

journey("ports are offered while the script is written", HERE, async ({ app }) => {
  await app.select(LABEL);
  await editorOf(app).click();
  await app.sheet.keyboard.press("Control+End");
  await app.sheet.keyboard.type("x = inputs[");
  await app.sheet.getByRole("listbox").getByRole("option", { name: "weight_g" }).waitFor();
});

journey("a script outlives a reload and is saved with the machine", HERE, async ({ app }) => {
  await app.select(LABEL);
  await write(app, "# not applied");
  await app.sheet.reload();
  await app.connected();
  await app.until(({ tab, canvas }) => tab !== null && canvas !== null, null);
  await app.select(LABEL);
  await app.sheet.getByText("Not applied yet").waitFor();
  expect(await script(app)).not.toContain("# not applied");
  await app.sheet.keyboard.press("Control+s");
  await app.until(({ tab }) => tab?.session.status.value?.summary.is_changed === false, null);
  expect(await script(app)).toContain("# not applied");
});

journey("a script that someone else changed is compared", HERE, async ({ app, colleague }) => {
  const anna = await colleague("anna");
  await anna.open("hierarchy_and_data");
  await app.select(LABEL);
  await write(app, "# mine");
  await anna.select(LABEL);
  await write(anna, "# theirs");
  await anna.sheet.keyboard.press("Control+Enter");
  await app.showsText("Someone else changed this script while you were editing");
  expect(await script(app)).toContain("# theirs");
  await app.sheet.getByRole("button", { name: "Compare…" }).click();
  const both = app.sheet.getByRole("dialog", { name: "Two versions of the script" });
  await both.getByRole("textbox", { name: "Theirs" }).getByText("# theirs").waitFor();
  await both.getByRole("button", { name: "Keep mine" }).click();
  await app.sheet.getByRole("button", { name: "Apply", exact: true }).click();
  await app.settled();
  expect(await script(app)).toContain("# mine");
  expect(await script(app)).not.toContain("# theirs");
});

journey("an outcome is led elsewhere by a choice", HERE, async ({ app }) => {
  await app.select(LABEL);
  const goal = app.sheet.getByRole("combobox", { name: "Target of aborted" });
  await goal.focus();
  await goal.selectOption({ label: "Pack one part" });
  await app.settled();
  const made = (await app.state("PACKER")).transitions?.find(
    ({ from_state, from_outcome }) => from_state === "LABELS" && from_outcome === -1,
  );
  expect(made?.to_state).toBe("ONEPAR");
  await goal.selectOption({ label: "nowhere" });
  await app.settled();
  expect((await app.state("PACKER")).transitions).not.toContainEqual(made);
});

journey("the inspector stays where it is pinned", HERE, async ({ app }) => {
  await app.select(LABEL);
  await app.sheet.getByRole("button", { name: "Pin this selection" }).click();
  await app.select("PACKER/ISFULL");
  const name = app.sheet.getByLabel("Name", { exact: true });
  expect(await name.inputValue()).toBe("Label the box");
  await app.sheet.getByRole("button", { name: "Follow the selection again" }).click();
  await expect.poll(() => name.inputValue()).toBe("Is the box full");
});

journey(
  "a global variable is renamed in every script",
  { open: "global_variables" },
  async ({ app }) => {
    await app.panel("Globals");
    await app.sheet.getByRole("treeitem", { name: /^in the basket/ }).click();
    await app.sheet.getByRole("button", { name: "Rename in the basket" }).click();
    await app.sheet.getByRole("textbox", { name: "New name" }).fill("basket");
    await app.sheet.getByRole("button", { name: "Rename everywhere" }).click();
    await app.sheet.getByRole("treeitem", { name: /^basket/ }).waitFor();
    await app.settled();
    expect(await script(app, "ORCHRD/COUNTS")).toContain('gvm.get_variable("basket")');
    expect(await script(app, "ORCHRD/PICKER/LEFTPK")).not.toContain("in the basket");
  },
);

journey("a library has its own values here", { open: "library_reuse" }, async ({ app }) => {
  const path = "PATROL/REPORT";
  await app.select(path);
  const table = app.sheet.getByRole("grid", { name: /^Inputs of/ });
  await table
    .getByRole("row", { name: /^subject/ })
    .getByRole("gridcell")
    .nth(2)
    .dblclick();
  await app.sheet.keyboard.press("Control+a");
  await app.sheet.keyboard.type("42");
  await app.sheet.keyboard.press("Enter");
  await app.settled();
  const values = async () => (await app.state(path)).library?.inputs ?? [];
  expect(await values()).toContainEqual({ port: 1, value: 42, used: true });
  await app.sheet.getByRole("checkbox", { name: "Use the value of subject here" }).click();
  await app.settled();
  expect(await values()).toContainEqual({ port: 1, value: 42, used: false });
});
