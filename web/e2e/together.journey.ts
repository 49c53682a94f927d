import { expect } from "vitest";
import { journey } from "./support/journey.ts";

const HERE = { open: "hierarchy_and_data" };
const FULL = "PACKER/ISFULL";
const LABEL = "PACKER/LABELS";

journey("two engineers see each other's selection and edits", HERE, async ({ app, colleague }) => {
  const anna = await colleague("anna");
  await anna.open("hierarchy_and_data");
  await anna.select(LABEL);
  await app.until(
    ({ tab }, key) =>
      tab?.session.people.value.some(({ selection }) => selection.includes(key)) === true,
    LABEL,
  );
  await app.select(FULL);
  await app.press("Delete");
  await anna.until(({ tab }, path) => tab?.session.machine.state(path) === undefined, FULL);
  expect(await anna.children()).toEqual(["Label the box", "Pack one part"]);
});

journey(
  "undo takes back one's own last edit, and leaves the other's",
  HERE,
  async ({ app, colleague }) => {
    const anna = await colleague("anna");
    await anna.open("hierarchy_and_data");
    await app.select(FULL);
    await app.press("Control+d");
    await app.settled();
    await anna.select(LABEL);
    const name = anna.sheet.getByLabel("Name", { exact: true });
    await name.fill("Write the label");
    await name.press("Enter");
    await anna.settled();
    await app.until(
      ({ tab }, path) => tab?.session.machine.state(path)?.name === "Write the label",
      LABEL,
    );
    await app.press("Control+z");
    await app.until(
      ({ tab }) => tab?.session.machine.children(tab.session.machine.root).length === 3,
      null,
    );
    expect((await app.state(LABEL)).name).toBe("Write the label");
  },
);

journey(
  "a jump over steps of others asks first, and can be undone",
  HERE,
  async ({ app, colleague }) => {
    const anna = await colleague("anna");
    await anna.open("hierarchy_and_data");
    await anna.select(FULL);
    await anna.press("Delete");
    await app.until(({ tab }, path) => tab?.session.machine.state(path) === undefined, FULL);
    await app.panel("Edits");
    const steps = app.sheet.getByRole("grid", { name: "Steps, newest first" });
    await steps.getByText("As it was opened").click();
    await app.sheet.getByRole("button", { name: "Go to this step" }).click();
    await app.sheet.getByRole("button", { name: "Cancel", exact: true }).click();
    expect((await app.children()).length).toBe(2);
    await app.sheet.getByRole("button", { name: "Go to this step" }).click();
    await app.sheet.getByRole("button", { name: "Go there anyway" }).click();
    await app.until(({ tab }, path) => tab?.session.machine.state(path) !== undefined, FULL);
    await app.press("Control+z");
    await app.until(({ tab }, path) => tab?.session.machine.state(path) === undefined, FULL);
  },
);
