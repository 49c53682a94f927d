/** Runs whose program dies in the middle: they say so, and go on as somebody decides. */

import { expect } from "vitest";
import type { App } from "./support/app.ts";
import { crashIn } from "./support/crash.ts";
import { journey } from "./support/journey.ts";
import { ended, exampleWith, press, stands, untilEndReceived } from "./support/runs.ts";

/** The first attempt takes until somebody ends it. */
const PRESS = `class Jammed(Exception):
    pass


def execute(self, inputs, outputs, gvm):
    if inputs["attempt"] == 1:
        gvm.set_variable("tries", gvm.get_variable("tries", default=0) + 1)
        if gvm.get_variable("tries") == 1:
            self.preemptive_wait(3600)
        raise Jammed("the plug stands askew")
    if inputs["attempt"] == 2:
        raise TimeoutError("the arm did not reach the socket")
    return "success"
`;
const MACHINE = exampleWith("error_recovery", {
  "Insert_the_plug_INSERT/Push_PUSHIN/Press_PRESSI/script.py": PRESS,
});
const SETTING = { machines: { error_recovery: MACHINE }, open: "error_recovery" };
const PRESSED = "PLUGIN/INSERT/PUSHIN/PRESSI";

async function untilOver(app: App): Promise<readonly string[]> {
  await ended(app, "success");
  await untilEndReceived(app);
  return app.sheet.evaluate(() => {
    const journal = window.__rafcon.page.active.value?.run.value?.journal;
    const all = [...Array(journal?.length ?? 0).keys()].map((index) => journal?.at(index));
    return all.flatMap((event) =>
      event?.kind === "left" ? [`${event.path} ${event.outcome?.name}`] : [],
    );
  });
}

journey("a run that crashed is resumed on the recovery path", SETTING, async ({ app, server }) => {
  await press(app, "Start");
  await crashIn(app, server, PRESSED, "tries");
  await stands(app, "crashed");
  await app.showsText(/The program of this run died in “Press”/);
  await app.sheet.getByRole("button", { name: "Decide…" }).click();
  const dialog = app.sheet.getByRole("dialog", { name: "Resume the run" });
  await dialog.getByText("Plug the cable in › Insert the plug › Push › Press").waitFor();
  await dialog.getByRole("button", { name: /^End them as aborted/ }).click();
  const ends = await untilOver(app);
  expect(ends).toContain(`${PRESSED} aborted`);
  expect(ends).toContain("PLUGIN/CHOOSE turn the plug");
});

journey("interrupted scripts wait for a decision", SETTING, async ({ app, server }) => {
  await press(app, "Start");
  await crashIn(app, server, PRESSED, "tries");
  await stands(app, "crashed");
  await app.sheet.getByRole("button", { name: "Decide…" }).click();
  const dialog = app.sheet.getByRole("dialog", { name: "Resume the run" });
  await dialog.getByRole("button", { name: /^Decide for each state/ }).click();
  await app.showsText(/The crash interrupted a script/);
  const bar = app.sheet.locator(".bar", { hasText: "The crash interrupted" });
  await bar.getByRole("button", { name: "Run again" }).click();
  await bar.waitFor({ state: "detached" });
  await press(app, "Resume");
  await untilOver(app);
});

journey("a run by the rule abort continues by itself", SETTING, async ({ app, server }) => {
  await app.menu("Run", "Start with…");
  const dialog = app.sheet.getByRole("dialog", { name: /^Start / });
  await dialog.getByLabel(/^Interrupted scripts/).selectOption("abort");
  await dialog.getByRole("button", { name: "Start", exact: true }).click();
  await crashIn(app, server, PRESSED, "tries");
  expect(await untilOver(app)).toContain("PLUGIN/CHOOSE turn the plug");
});

const SAYS = exampleWith("error_recovery", {
  "Insert_the_plug_INSERT/Push_PUSHIN/Press_PRESSI/script.py": PRESS,
  "semantic_data.json": JSON.stringify({ on_crash: "restart" }),
});

journey(
  "a run whose machine itself says what a crash means continues by itself",
  { machines: { error_recovery: SAYS }, open: "error_recovery" },
  async ({ app, server }) => {
    await press(app, "Start");
    await crashIn(app, server, PRESSED, "tries");
    await untilOver(app);
    const policies = await app.sheet.evaluate(() =>
      [...(window.__rafcon.page.active.value?.run.value?.journal.others() ?? [])].flatMap(
        ([, event]) => (event.type === "resumed" ? [event.policy] : []),
      ),
    );
    expect(policies).toEqual(["restart"]);
  },
);
