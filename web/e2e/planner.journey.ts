import type { Page as Sheet } from "playwright-core";
import { expect } from "vitest";
import type { App } from "./support/app.ts";
import { journey } from "./support/journey.ts";
import { missionFolder } from "./support/mission.ts";
import { engine, roverSkills } from "./support/skills.ts";

const HERE = {
  machines: { errand: missionFolder("errand", []) },
  libraries: { skills: roverSkills() },
  open: "errand",
  programs: () => [engine()],
};

const WORLD = `(define (problem errand) (:domain rover)
  (:objects dock shelf table - Place cup plate - Thing)
  (:init (rover-at dock) (hand-empty) (at cup shelf) (at plate table))
  (:goal (at cup table)))`;

function panelOf({ sheet }: App) {
  return sheet.locator(".planner");
}

async function addSkills(app: App, path: string): Promise<void> {
  await panelOf(app).getByLabel("Add libraries").fill(path);
  await app.sheet.keyboard.press("Enter");
}

async function loadWorld(app: App, text: string): Promise<void> {
  const file = { name: "world.pddl", mimeType: "text/plain", buffer: Buffer.from(text) };
  await panelOf(app).getByLabel("PDDL problem or world file").setInputFiles(file);
}

/** Writes a goal as a person does. */
async function writeGoal(sheet: Sheet, text: string): Promise<void> {
  const goal = sheet.getByRole("textbox", { name: "Goal" });
  await goal.focus();
  await sheet.keyboard.press("Control+a");
  await sheet.keyboard.insertText(text);
}

function steps(app: App) {
  return panelOf(app).getByRole("list", { name: "Steps of the plan" }).getByRole("listitem");
}

/** The states that the canvas shows as an offer. */
async function offered(app: App): Promise<number> {
  return app.sheet.evaluate(() => {
    const ghost = window.__rafcon.context().tab?.view.ghost.value;
    return ghost ? [...ghost.machine.paths()].length : 0;
  });
}

async function plan(app: App): Promise<void> {
  await panelOf(app)
    .getByRole("button", { name: /^Plan( again)?$/ })
    .click();
  await panelOf(app).getByText("The plan is on the canvas").waitFor();
}

journey(
  "a goal becomes a plan, the plan a part of the machine by one edit",
  HERE,
  async ({ app }) => {
    await app.menu("Insert", "Plan…");
    await addSkills(app, "skills/rover");
    await panelOf(app).getByText("3 skills, 4 predicates").waitFor();
    await loadWorld(app, WORLD);
    await plan(app);
    expect(await steps(app).allTextContents()).toEqual([
      "1Drive dock shelf",
      "2Pick cup shelf",
      "3Drive shelf table",
      "4Put cup table",
    ]);
    // The hierarchy and a state for each step, of which the machine has none yet.
    expect(await offered(app)).toBe(5);
    expect(await app.children()).toEqual([]);

    await steps(app)
      .nth(1)
      .getByRole("button", { name: /Pick cup shelf/ })
      .click();
    const why = await steps(app).nth(1).textContent();
    expect(why).toContain("(rover-at shelf) by 1 Drive dock shelf");
    expect(why).toContain("(at cup shelf) there from the beginning");
    expect(why).toContain("(holding cup) for 4 Put cup table");

    await panelOf(app).getByRole("button", { name: "Accept" }).click();
    await app.settled();
    expect(await app.lastStep()).toBe("Accept plan errand");
    expect(await app.children()).toEqual(["errand"]);
    expect(await offered(app)).toBe(0);
    await steps(app)
      .nth(3)
      .getByRole("button", { name: /Put cup table/ })
      .click();
    await app.selected(`state:${await app.path("Put cup table")}`);
    await app.press("Control+z");
    await app.settled();
    expect(await app.children()).toEqual([]);
  },
);

journey("another goal shows what is other than before", HERE, async ({ app }) => {
  await app.menu("Insert", "Plan…");
  await addSkills(app, "skills/rover");
  await loadWorld(app, WORLD);
  await plan(app);
  await writeGoal(app.sheet, "(at cup table)\n(rover-at dock)");
  await plan(app);
  await panelOf(app).getByText("Against the plan before: 1 added, 0 removed, 4 kept").waitFor();
  expect(await steps(app).last().textContent()).toBe("added+5Drive table dock");
});

journey("what does not fit is told, and leads to the library", HERE, async ({ app }) => {
  await app.menu("Insert", "Plan…");
  await addSkills(app, "skills");
  await panelOf(app).getByLabel("Error").first().waitFor();
  await loadWorld(app, WORLD);
  await panelOf(app).getByRole("button", { name: "Plan", exact: true }).click();
  const wrong = panelOf(app).getByRole("region", { name: /Problems/ });
  await wrong.getByRole("button", { name: "skills/odd/park" }).first().click();
  await app.until(
    ({ tab }) => tab?.session.machine.state(tab.session.machine.root)?.name === "Park",
    null,
  );
});

journey("names are completed as they are written", HERE, async ({ app }) => {
  await app.menu("Insert", "Plan…");
  await addSkills(app, "skills/rover");
  await panelOf(app).getByText("3 skills, 4 predicates").waitFor();
  await loadWorld(app, WORLD);
  await writeGoal(app.sheet, "");
  await app.sheet.keyboard.type("(");
  const offers = app.sheet.getByRole("listbox", { name: "Completions" });
  await offers.getByRole("option", { name: /^holding/ }).click();
  await app.sheet.keyboard.type(" ");
  await offers.waitFor();
  expect(await offers.getByRole("option").allTextContents()).toEqual(["cupThing", "plateThing"]);
});

journey("a state becomes a skill in the inspector", HERE, async ({ app }) => {
  await app.press("E");
  await app.settled();
  const path = `${await app.path("errand")}/${(await app.selection())[0]?.split("/").at(-1)}`;
  const inspector = app.sheet.locator(".inspector");
  await app.panel("Inspector");
  await inspector.getByRole("button", { name: "Planner", exact: true }).click();
  await inspector.getByRole("button", { name: "Add a planner annotation" }).click();
  const action = inspector.getByRole("textbox", { name: "Action" });
  await action.focus();
  await app.sheet.keyboard.press("Control+a");
  await app.sheet.keyboard.insertText(
    "(:action scan :parameters (?place - Place) :precondition (and) :effect (seen ?place))",
  );
  await app.sheet.keyboard.press("Control+Enter");
  const wrong = inspector.getByRole("list", { name: "Skill problems" });
  await wrong.getByText("No input is called place").waitFor();
  await inspector.getByRole("button", { name: "Fill in predicates and types" }).click();
  await app.settled();
  const data = (await app.state(path)).semantic_data;
  expect(data).toMatchObject({
    RAFCONTPP: {
      PDDL_ACTION: { pddl_predicates: "(seen ?place - Place)", pddl_types: "Place" },
    },
  });
  expect(await wrong.getByRole("listitem").allTextContents()).toEqual([
    "No input is called place: the state does not learn its value.",
  ]);
});

const WITHOUT_ENGINE = { machines: HERE.machines, open: "errand" };

journey(
  "facts and goal look the same after the page is loaded again",
  WITHOUT_ENGINE,
  async ({ app }) => {
    const facts = app.sheet.getByRole("textbox", { name: "Facts" });
    const style = () =>
      facts.evaluate((field) => {
        const { padding, fontFamily, backgroundColor } = getComputedStyle(field);
        return { padding, fontFamily, backgroundColor };
      });
    await app.command("Plan…");
    await facts.waitFor();
    const before = await style();
    expect(before.padding).not.toBe("0px");
    await app.sheet.reload();
    await app.connected();
    await facts.waitFor();
    expect(await style()).toEqual(before);
  },
);
