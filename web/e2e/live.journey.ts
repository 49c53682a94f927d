/** The live view: what the canvas shows of a run, what runs now, and how the camera follows. */

import type { App } from "./support/app.ts";
import { journey } from "./support/journey.ts";
import { ringed, unringed } from "./support/live.ts";
import {
  ended,
  exampleWith,
  heldBefore,
  perform,
  press,
  stopRun,
  untilActive,
  untilEndReceived,
} from "./support/runs.ts";

const PACKER = "PACKER";
const FULL = "PACKER/ISFULL";
const PART = "PACKER/ONEPAR";
const PICK = "PACKER/ONEPAR/PICKIT";

/** The packer whose check takes as long as it is let. */
const WAITS = `def execute(self, inputs, outputs, gvm):
    self.preemptive_wait(600)
    return "full"
`;

/** A machine that stays in its first state. */
function waiting() {
  const machine = exampleWith("hierarchy_and_data", {
    "Is_the_box_full_ISFULL/script.py": WAITS,
  });
  return { machines: { hierarchy_and_data: machine }, open: "hierarchy_and_data" } as const;
}

const panel = async (app: App) => {
  await app.menu("View", "Layout");
  await app.sheet.getByRole("menuitem", { name: "Debug" }).click();
  await app.panel("Running");
  return app.sheet.getByRole("list", { name: "Active now" });
};

journey(
  "a state lights up while it runs, and goes out when it ends",
  waiting(),
  async ({ app }) => {
    await perform(app, "run.start", undefined);
    await untilActive(app, FULL);
    await ringed(app, FULL, "running");
    await ringed(app, PACKER, "running");
    await unringed(app, PART, "running");
    await stopRun(app);
    await unringed(app, FULL, "running");
    await ringed(app, FULL, "preempted");
  },
);

journey(
  "what is held shows what comes next, and behind it the way that it came",
  { open: "hierarchy_and_data" },
  async ({ app }) => {
    await perform(app, "run.start-held", undefined);
    await heldBefore(app, FULL);
    await ringed(app, PACKER, "held");
    await ringed(app, FULL, "held");
    await press(app, "Into");
    await heldBefore(app, PART);
    await ringed(app, FULL, "canvas-trail");
    await ringed(app, PART, "held");
    await press(app, "Into");
    await heldBefore(app, PICK);
    await unringed(app, PACKER, "held");
    await ringed(app, PART, "held");
    await press(app, "Back");
    await heldBefore(app, PART);
    await ringed(app, PACKER, "held");
    await press(app, "Back");
    await heldBefore(app, FULL);
    await unringed(app, FULL, "canvas-trail");
    await stopRun(app);
  },
);

journey(
  "a state that failed keeps its mark until someone acknowledges it",
  { open: "error_recovery" },
  async ({ app }) => {
    const push = "PLUGIN/INSERT/PUSHIN";
    await perform(app, "run.start", undefined);
    await ended(app, "success");
    await ringed(app, push, "aborted");
    await app.menu("View", "Layout");
    await app.sheet.getByRole("menuitem", { name: "Mission control", exact: true }).click();
    await app.press("f");
    await ringed(app, push, "aborted");
    await app.sheet.getByRole("button", { name: "Acknowledge all" }).click();
    await unringed(app, push, "aborted");
  },
);

journey(
  "at an earlier moment the canvas shows that moment, and now again when asked",
  { open: "hierarchy_and_data" },
  async ({ app }) => {
    await perform(app, "run.start", undefined);
    await ended(app, "success");
    await untilEndReceived(app);
    await unringed(app, PACKER, "running");
    const list = await panel(app);
    await app.press("f");
    await app.press(",");
    await app.until(({ tab }) => tab?.run.value?.playhead.value != null, null);
    await app.press(",");
    await ringed(app, PACKER, "running");
    await list.getByRole("button").first().waitFor();
    await perform(app, "run.live", undefined);
    await unringed(app, PACKER, "running");
    await app.sheet.getByText("Nothing is running", { exact: true }).waitFor();
  },
);

journey("what runs now is listed, and leads there", waiting(), async ({ app }) => {
  const list = await panel(app);
  await app.sheet.getByText("No run is shown").first().waitFor();
  await perform(app, "run.start", undefined);
  await untilActive(app, FULL);
  const row = list.getByRole("button", { name: /Is the box full/ });
  await row.getByText("runs").waitFor();
  await row.click();
  await app.selected(`state:${FULL}`);
  await stopRun(app);
  await app.sheet.getByText("Nothing is running").first().waitFor();
});

journey(
  "each branch has its own steps at the place where it is held",
  { open: "preemptive_with_timer" },
  async ({ app, server }) => {
    const looker = await app.path("Look around");
    const look = await app.path("Look");
    const machine = { project: "missions", path: "preemptive_with_timer" };
    const inputs = { limit_s: 600, hidden_at_deg: 45 };
    const breakpoint = {
      id: 1,
      path: look,
      when: "before",
      condition: null,
      hit_count: 0,
      scope: "branch",
      unattended: "hold",
      enabled: true,
    };
    const run = await server.ask<{ id: string }>("POST", "/runs", {
      id: "by-hand",
      machine,
      inputs,
      breakpoints: [breakpoint],
    });
    await perform(app, "run.show", run.id);
    await heldBefore(app, look);
    const timer = await app.path("Timer");
    await ringed(app, timer, "running");
    await ringed(app, looker, "held");
    await app.sheet.getByRole("button", { name: "Step over: Look around only" }).click();
    await heldBefore(app, await app.path("Turn"));
    await ringed(app, timer, "running");
    await stopRun(app);
  },
);

const scale = (app: App) =>
  app.sheet.evaluate(() => window.__rafcon.context().tab?.view.camera.value.scale ?? 0);

/** Zooms out until the machine is tiny. */
async function zoomFarOut(app: App): Promise<void> {
  const { width, height, x, y } = (await app.canvas.boundingBox()) ?? {
    x: 0,
    y: 0,
    width: 0,
    height: 0,
  };
  await app.sheet.mouse.move(x + width / 2, y + height / 2);
  for (let turn = 0; turn < 12; turn++) {
    const before = await scale(app);
    await app.sheet.mouse.wheel(0, 500);
    await app.until(({ tab }, was) => (tab?.view.camera.value.scale ?? was) < was, before);
  }
}

journey("the camera follows what runs, until someone moves it", waiting(), async ({ app }) => {
  await perform(app, "run.start", undefined);
  await untilActive(app, FULL);
  await zoomFarOut(app);
  const small = await scale(app);
  const follow = app.sheet.getByRole("button", { name: "Follow active states" });
  await follow.click();
  await app.until(({ tab }, was) => (tab?.view.camera.value.scale ?? 0) > was * 3, small);
  await ringed(app, FULL, "running");
  await app.sheet.getByRole("button", { name: "Follow active states", pressed: true }).waitFor();
  await app.sheet.mouse.move(700, 400);
  await app.sheet.mouse.wheel(0, 200);
  await app.showsText(/no longer follows the active states/);
  await app.sheet.getByRole("button", { name: "Follow active states", pressed: false }).waitFor();
  await app.sheet.getByRole("button", { name: "Follow again" }).click();
  await app.sheet.getByRole("button", { name: "Follow active states", pressed: true }).waitFor();
  await stopRun(app);
});

journey(
  "heat shows how often states ran, and then how long",
  { open: "hierarchy_and_data" },
  async ({ app }) => {
    await perform(app, "run.start", undefined);
    await ended(app, "success");
    await app.sheet.getByRole("button", { name: "Heat: none" }).click();
    await app.sheet.getByRole("img", { name: "Executions per state: from 1× to 6×" }).waitFor();
    await app.press("Shift+h");
    await app.sheet.getByRole("img", { name: /^Total time per state/ }).waitFor();
    await app.press("Shift+h");
    await app.sheet.getByRole("button", { name: "Heat: none" }).waitFor();
  },
);
