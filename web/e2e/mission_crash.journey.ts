/** Mission control after the program of a run died: what is told, and what each choice does. */

import { expect } from "vitest";
import type { App } from "./support/app.ts";
import { crashIn } from "./support/crash.ts";
import { type Hands, journey } from "./support/journey.ts";
import {
  endRun,
  missionFolder,
  missionOf,
  openMission,
  startRun,
  status,
} from "./support/mission.ts";

const PRESS = "MISSIO/PRESSI";
/** The first life waits at the press; whoever runs it again is done at once. */
const MACHINE = missionFolder("presses", [
  {
    id: "PRESSI",
    name: "Press",
    script: [
      'tries = gvm.get_variable("tries", default=0) + 1',
      'gvm.set_variable("tries", tries)',
      'return "success" if tries > 1 or not self.preemptive_wait(3600) else "preempted"',
    ],
  },
  { id: "DRIVEE", name: "Drive to the bay", script: ["self.preemptive_wait(3600)"] },
]);

/** With a run that crashed while mission control shows it. */
function crashed(name: string, go: (hands: Hands, run: string) => Promise<void>): void {
  journey(name, { machines: { presses: MACHINE }, open: "presses" }, async (hands) => {
    const { app, server } = hands;
    const run = await startRun(server, "presses");
    await openMission(app, "presses");
    await crashIn(app, server, PRESS, "tries");
    await status(app).getByText("crashed").waitFor();
    await choices(app)
      .getByText(/It was at .*Press/)
      .waitFor();
    await go(hands, run);
    await endRun(server, run);
  });
}

function choices(app: App) {
  return missionOf(app).getByRole("region", { name: "The run crashed" });
}

async function take(app: App, choice: string): Promise<void> {
  await choices(app).getByRole("button", { name: choice }).click();
  await choices(app).waitFor({ state: "detached" });
}

/** How the interrupted state ended, once the next one is at work. */
async function endsOfPress(app: App): Promise<readonly string[]> {
  await missionOf(app).getByRole("button", { name: "Drive to the bay" }).waitFor();
  return app.sheet.evaluate((path) => {
    const journal = window.__rafcon.page.active.value?.run.value?.journal;
    const all = [...Array(journal?.length ?? 0).keys()].map((index) => journal?.at(index));
    return all.flatMap((event) =>
      event?.kind === "left" && event.path === path ? [event.outcome?.name ?? ""] : [],
    );
  }, PRESS);
}

crashed("after a crash scripts are run again by mission control", async ({ app }) => {
  await take(app, "Run scripts again");
  expect(await endsOfPress(app)).toEqual(["success"]);
});

crashed("after a crash scripts are aborted by mission control", async ({ app }) => {
  await take(app, "Abort scripts");
  expect(await endsOfPress(app)).toEqual(["aborted"]);
});

crashed("after a crash mission control asks for each script, and it decides", async ({ app }) => {
  await take(app, "Resume and ask");
  const waiting = missionOf(app).getByRole("region", { name: "Interrupted scripts" });
  await waiting.getByText("Press").first().waitFor();
  await waiting.getByRole("button", { name: "End as aborted" }).click();
  await waiting.waitFor({ state: "detached" });
  await missionOf(app).getByRole("button", { name: "Resume", exact: true }).click();
  expect(await endsOfPress(app)).toEqual(["aborted"]);
});

crashed(
  "a crash that nobody resumes stays told, to viewers too and after a reload",
  async ({ app, colleague }, run) => {
    const vera = await colleague("vera", "viewer");
    await vera.sheet.goto(`${vera.server.url}/?layout=mission&run=${run}`);
    await choices(vera).getByText("You cannot resume it: only operators").waitFor();
    await app.sheet.reload();
    await app.connected();
    await choices(app).getByRole("button", { name: "Resume and ask" }).waitFor();
    await status(app).getByText("crashed").waitFor();
  },
);
