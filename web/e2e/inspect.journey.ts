import { expect } from "vitest";
import type { App } from "./support/app.ts";
import { journey } from "./support/journey.ts";

const HERE = { open: "hierarchy_and_data" };
const LABEL = "PACKER/LABELS";

/** Writes into a cell of a table, as one does: double click, text, Enter. */
async function write(app: App, table: string, row: string, column: number, text: string) {
  const line = app.sheet.getByRole("grid", { name: table }).getByRole("row", { name: row });
  await line.getByRole("gridcell").nth(column).dblclick();
  await app.sheet.keyboard.press("Control+a");
  await app.sheet.keyboard.type(text);
  await app.sheet.keyboard.press("Enter");
  await app.settled();
}

journey("a state is renamed in the inspector", HERE, async ({ app }) => {
  await app.select(LABEL);
  const name = app.sheet.getByLabel("Name", { exact: true });
  await name.fill("Write the label");
  await name.press("Enter");
  await app.settled();
  expect((await app.state(LABEL)).name).toBe("Write the label");
});

journey("a port gets another name, type and default", HERE, async ({ app }) => {
  await app.select(LABEL);
  const table = "Inputs of Label the box";
  await write(app, table, "weight_g", 2, "2.5");
  expect((await app.state(LABEL)).inputs?.find(({ name }) => name === "weight_g")?.default).toBe(
    2.5,
  );
  await write(app, table, "count", 2, "no number");
  await app.sheet.getByRole("alert").filter({ hasText: "no is not a value" }).waitFor();
  await app.sheet.keyboard.press("Escape");
  expect((await app.state(LABEL)).inputs?.find(({ name }) => name === "count")?.default).toBe(0);
});

journey("an outcome and a port are added and removed in the inspector", HERE, async ({ app }) => {
  await app.select(LABEL);
  await app.sheet.getByRole("button", { name: "Add input" }).click();
  await app.sheet.locator("input.table-edit:focus").waitFor();
  await app.sheet.keyboard.type("colour");
  await app.sheet.keyboard.press("Enter");
  await app.settled();
  expect((await app.state(LABEL)).inputs?.map(({ name }) => name)).toContain("colour");
  await app.press("Control+z");
  await app.press("Control+z");
  await app.settled();
  expect((await app.state(LABEL)).inputs?.length).toBe(2);
});

journey("a script with a mistake says where it is", HERE, async ({ app }) => {
  await app.select(LABEL);
  const editor = app.sheet.locator(".cm-content").first();
  await editor.click();
  await app.sheet.keyboard.press("Control+a");
  await app.sheet.keyboard.type("def execute(self, inputs, outputs, gvm)\nreturn");
  await app.sheet.locator(".cm-lintRange-error, .cm-lint-marker-error").first().waitFor();
});

journey("a script is written and applied as one step", HERE, async ({ app }) => {
  await app.select(LABEL);
  await app.sheet.locator(".cm-content").first().click();
  await app.sheet.keyboard.press("Control+Home");
  await app.sheet.keyboard.type("# written here\n");
  await app.sheet.keyboard.press("Control+Enter");
  await app.until(
    ({ tab }, path) =>
      tab?.session.machine.state(path)?.script?.startsWith("# written here") === true,
    LABEL,
  );
});

journey(
  "a description cannot cover the page, and its links open beside it",
  HERE,
  async ({ app }) => {
    const complaints: string[] = [];
    app.sheet.on(
      "console",
      (message) => message.type() === "error" && complaints.push(message.text()),
    );
    await app.select(LABEL);
    const shown = async () => (await app.sheet.locator(".inspector-markdown").innerHTML()).trim();
    const check = async (text: string, expected: string) => {
      const write = { name: /^(Describe this state|Edit the description)$/ };
      await app.sheet.getByRole("button", write).click();
      await app.sheet.getByLabel("Description, in Markdown").fill(text);
      await app.sheet.keyboard.press("Control+Enter");
      await expect.poll(shown).toBe(expected);
    };
    await check('<p style="position:fixed" class="menu-shield" id="app">over</p>', "<p>over</p>");
    await check('a <svg width="9"><rect></rect></svg><button>b</button>', "<p>a b</p>");
    await check("<img src=x onerror=alert(1)><script>alert(1)</script>t", "<p>t</p>");
    await check(
      "[docs](https://example.org) [run](javascript:alert)",
      '<p><a href="https://example.org" target="_blank" rel="noopener noreferrer">docs</a> <a>run</a></p>',
    );
    await check("- [x] **done**", "<ul>\n<li>☑ <strong>done</strong></li>\n</ul>");
    expect(complaints).toEqual([]);
  },
);

journey("a state says what it does once the ground is silent", HERE, async ({ app }) => {
  await app.select("PACKER");
  await app.sheet.getByRole("button", { name: /^Lost link/ }).click();
  const policy = () => app.sheet.getByLabel("Policy").first();
  await policy().selectOption({ label: "Act after a time" });
  await app.settled();
  const recover = app.sheet.getByLabel("Recover after (s)");
  await recover.fill("600");
  await recover.press("Enter");
  await app.settled();
  expect((await app.state("PACKER")).semantic_data).toEqual({
    lost_link: { hold_s: 30, recover_s: 600 },
  });
  await app.select(LABEL);
  await policy()
    .locator("option", { hasText: /^As .*: pause after 30 s, recover after 600 s$/ })
    .waitFor({ state: "attached" });
});
