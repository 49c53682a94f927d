import { readFileSync } from "node:fs";
import { join } from "node:path";
import type { Locator } from "playwright-core";
import { expect, vi } from "vitest";
import type { App } from "./support/app.ts";
import { journey } from "./support/journey.ts";
import {
  control,
  endRun,
  eventually,
  missionFolder,
  missionOf,
  openMission,
  startRun,
  status,
  untilOver,
} from "./support/mission.ts";
import { PATIENCE } from "./support/patience.ts";
import { answer } from "./support/runs.ts";
import type { Server } from "./support/server.ts";

const DRIVE = { id: "DRIVEE", name: "Drive to the bay", script: ["self.preemptive_wait(600)"] };
const ASKS = {
  id: "WEIGHT",
  name: "Weigh the box",
  script: [
    "from rafcon import dialog",
    'answer = dialog.number("How heavy is the box, in kg?", 0, 30, timeout=600, default=10)',
    'self.logger.info("%s kg" % answer.number)',
  ],
};
const FAILS = {
  id: "LOADIN",
  name: "Load the box",
  script: ['self.logger.warning("the left gripper slips")', 'raise RuntimeError("no box here")'],
};
const MACHINES = {
  asks: missionFolder("asks", [ASKS, DRIVE]),
  drives: missionFolder("drives", [DRIVE]),
  fails: missionFolder("fails", [FAILS, DRIVE]),
  weighs: missionFolder("weighs", [
    { id: "WEIGHT", name: "Weigh", script: ['gvm.set_variable("weight", 12.5)'] },
    DRIVE,
  ]),
};

/** With a run of one of the machines, which ends in any case. */
async function during(server: Server, machine: string, go: () => Promise<void>): Promise<void> {
  const run = await startRun(server, machine);
  try {
    await go();
  } finally {
    await endRun(server, run);
  }
}

journey(
  "one of two people answers a question, and the other sees by whom",
  { machines: MACHINES, open: "asks" },
  async ({ app, server, colleague }) => {
    await during(server, "asks", async () => {
      const anna = await colleague("anna", "operator");
      await openMission(app, "asks");
      await openMission(anna, "asks");
      const [mine, hers] = [missionOf(app), missionOf(anna)];
      await mine.getByText("How heavy is the box, in kg?").waitFor();
      await app.sheet.getByRole("button", { name: "1 question" }).waitFor();
      await hers.getByLabel("Your answer").fill("31");
      await hers.getByText("31 is too large; the maximum is 30.").waitFor();
      expect(await hers.getByRole("button", { name: "OK" }).isDisabled()).toBe(true);
      await hers.getByLabel("Your answer").fill("12.5");
      await hers.getByRole("button", { name: "OK" }).click();
      await mine.getByText("anna answered “OK: 12.5”").waitFor();
      await mine.getByRole("form").waitFor({ state: "detached" });
      await mine.getByRole("button", { name: "Drive to the bay" }).waitFor();
      await control(app).getByText("anna is").waitFor();
    });
  },
);

journey(
  "two operators hand over control",
  { machines: MACHINES, open: "drives" },
  async ({ server, colleague }) => {
    await during(server, "drives", async () => {
      const anna = await colleague("anna", "operator");
      const bob = await colleague("bob", "operator");
      await openMission(anna, "drives");
      await openMission(bob, "drives");
      await control(anna).getByRole("button", { name: "Take control" }).click();
      await control(anna).getByText("You are in control").waitFor();
      await control(bob).getByText("anna is in control").waitFor();
      await control(bob).getByRole("button", { name: "Ask for control" }).click();
      await control(bob).getByText("You ask for control").waitFor();
      await control(anna).getByText("bob asks for control").waitFor();
      await control(anna).getByRole("button", { name: "Hand over to bob" }).click();
      await control(bob).getByText("You are in control").waitFor();
      await control(anna).getByText("bob is in control").waitFor();
      await control(bob).getByRole("button", { name: "Release" }).click();
      await control(anna).getByText("Nobody is in control").waitFor();
    });
  },
);

journey(
  "control that is offered has to be accepted, and an admin takes it from its holder",
  { machines: MACHINES, open: "drives" },
  async ({ app, server, colleague }) => {
    await during(server, "drives", async () => {
      const anna = await colleague("anna", "operator");
      const bob = await colleague("bob", "operator");
      for (const person of [anna, bob, app]) await openMission(person, "drives");
      await control(anna).getByRole("button", { name: "Take control" }).click();
      await control(anna).getByText("You are in control").waitFor();
      const offer = async () => {
        await control(anna).getByRole("button", { name: "Hand over to…" }).click();
        const asked = anna.sheet.getByRole("dialog", { name: "Hand control over" });
        await asked.getByLabel("User").fill("bob");
        await anna.sheet.keyboard.press("Enter");
        await control(bob).getByText("anna offers you control").waitFor();
      };
      await offer();
      await control(anna).getByText("Offered to bob, not accepted yet").waitFor();
      await control(bob).getByRole("button", { name: "Decline" }).click();
      await control(anna).getByText("Offered to bob").waitFor({ state: "detached" });
      await offer();
      await control(bob).getByRole("button", { name: "Accept" }).click();
      await control(bob).getByText("You are in control").waitFor();
      await control(app).getByRole("button", { name: "Take control…" }).click();
      await answer(app, "Take control from bob?", "Take control");
      await control(app).getByText("You are in control").waitFor();
      await control(bob).getByText("owner is in control").waitFor();
    });
  },
);

journey(
  "who is silent for long loses control to whoever takes it over",
  { machines: MACHINES, open: "drives" },
  async ({ server, colleague }) => {
    await during(server, "drives", async () => {
      const anna = await colleague("anna", "operator");
      const bob = await colleague("bob", "operator");
      await openMission(anna, "drives");
      await openMission(bob, "drives");
      await control(anna).getByRole("button", { name: "Take control" }).click();
      await control(bob).getByText("anna is in control").waitFor();
      const takeOver = control(bob).getByRole("button", { name: "Take over" });
      await control(bob).getByText("possible after anna has been silent").waitFor();
      expect(await takeOver.isDisabled()).toBe(true);
      await anna.sheet.close();
      await eventually(() => takeOver.isEnabled());
      await takeOver.click();
      await control(bob).getByText("You are in control").waitFor();
    });
  },
);

journey(
  "a viewer sees all of it, and why there is nothing to press",
  { machines: MACHINES, open: "asks" },
  async ({ server, colleague }) => {
    await during(server, "asks", async () => {
      const vera = await colleague("vera", "viewer");
      await openMission(vera, "asks");
      const mission = missionOf(vera);
      await mission.getByText("How heavy is the box, in kg?").waitFor();
      await mission.getByText("You are vera: viewer").waitFor();
      await mission.getByText(/^Only operators, engineers and admins may command runs/).waitFor();
      await mission.getByText("You cannot answer: only operators").waitFor();
      await mission.getByText("You cannot take control: only operators").waitFor();
      for (const name of ["Stop", "Pause", "Resume", "Step", "Cancel"]) {
        const button = mission.getByRole("button", { name, exact: true });
        expect(await button.isDisabled(), name).toBe(true);
      }
    });
  },
);

journey(
  "hold and stop ask once, by a second press in the same place; a double press is none",
  { machines: MACHINES, open: "drives" },
  async ({ app, server }) => {
    await during(server, "drives", async () => {
      await openMission(app, "drives");
      const mission = missionOf(app);
      const button = (name: string) => mission.getByRole("button", { name, exact: true });
      const untilRunning = () =>
        app.until(({ tab }) => tab?.run.value?.now.value?.snapshot?.status === "running", null);
      const hammer = async (name: string, until: Locator) => {
        await button(name).focus();
        const strike = async () => {
          await app.sheet.keyboard.press("Enter");
          return until.isVisible();
        };
        await vi.waitUntil(strike, PATIENCE);
      };
      const carriedOut = mission.getByText("Pause was carried out");
      await Promise.all([carriedOut.waitFor(), hammer("Pause", status(app).getByText("paused"))]);
      await button("Resume").click();
      await mission.getByText("Running").waitFor();
      await Promise.all([button("Press again: stop").waitFor(), button("Stop").dblclick()]);
      await button("Stop").waitFor();
      await untilRunning();
      await hammer("Stop", status(app).getByText("finished"));
      await untilOver(app);
    });
  },
);

journey(
  "stop and hold stay where they are, whether a question waits, is answered or the link is gone",
  { machines: MACHINES, open: "asks" },
  async ({ app, server }) => {
    await during(server, "asks", async () => {
      await openMission(app, "asks");
      const mission = missionOf(app);
      const places = () =>
        Promise.all(
          ["Stop", "Pause"].map((name) =>
            mission.getByRole("button", { name, exact: true }).boundingBox(),
          ),
        );
      await mission.getByRole("button", { name: /^1 question/ }).waitFor();
      const asked = await places();
      await mission.getByRole("button", { name: "Cancel" }).click();
      await mission.getByRole("button", { name: /^1 event/ }).waitFor();
      expect(await places()).toEqual(asked);
      await server.end("SIGKILL");
      await mission.getByText("No answer from the server").waitFor();
      expect(await places()).toEqual(asked);
      await server.restart();
      await mission.getByText(/^Live/).waitFor();
      expect(await places()).toEqual(asked);
    });
  },
);

journey(
  "one press leads from the line of what waits to the question with the least time",
  { machines: MACHINES, open: "asks" },
  async ({ app, server }) => {
    await during(server, "asks", async () => {
      await openMission(app, "asks");
      const mission = missionOf(app);
      await mission.getByRole("button", { name: /^1 question/ }).press("Enter");
      await app.sheet.keyboard.type("12");
      expect(await mission.getByLabel("Your answer").inputValue()).toBe("12");
    });
  },
);

journey(
  "what went wrong stays until someone has seen it",
  { machines: MACHINES, open: "fails" },
  async ({ app, server }) => {
    await during(server, "fails", async () => {
      await openMission(app, "fails");
      const events = missionOf(app).getByRole("region", { name: "Events to acknowledge" });
      await events.getByText("To acknowledge: 2").waitFor();
      await events.getByText("RuntimeError: no box here").waitFor();
      await app.until(() => document.title.startsWith("❗"), null);
      await events.getByRole("button", { name: "Acknowledge", exact: true }).first().click();
      await events.getByText("To acknowledge: 1").waitFor();
      await events.getByText("RuntimeError: no box here").waitFor({ state: "detached" });
      await app.sheet.reload();
      await app.connected();
      await events.getByText("To acknowledge: 1").waitFor();
      await events.getByRole("button", { name: "Acknowledge", exact: true }).click();
      await events.getByText("Nothing to acknowledge").waitFor();
      await app.until(() => document.title.startsWith("▶"), null);
      await events.getByRole("button", { name: "All 2" }).click();
      await events.getByText("RuntimeError: no box here").waitFor();
    });
  },
);

journey(
  "an operator comes to mission control, and is told what matters elsewhere",
  { machines: MACHINES, open: "asks" },
  async ({ server, colleague }) => {
    await during(server, "asks", async () => {
      const anna = await colleague("anna", "operator");
      await missionOf(anna).getByText("Which mission?").waitFor();
      await openMission(anna, "asks");
      await anna.menu("View", "Layout");
      await anna.sheet
        .getByRole("menu")
        .getByRole("menuitem", { name: "Edit", exact: true })
        .click();
      await missionOf(anna).waitFor({ state: "detached" });
      await anna.sheet.getByRole("button", { name: "1 question" }).click();
      await missionOf(anna).getByText("How heavy is the box, in kg?").waitFor();
    });
  },
);

journey(
  "values that are watched stand beside what runs",
  { machines: MACHINES, open: "weighs" },
  async ({ app, server }) => {
    const [project] = await server.ask<readonly { readonly id: string }[]>("GET", "/projects");
    const target = { kind: "global", path: "", name: "weight" };
    const watched = [{ id: 1, target, expression: "value" }];
    const kept = JSON.stringify({ [`${project?.id}/weighs`]: watched });
    await app.sheet.evaluate((text) => localStorage.setItem("rafcon.watched", text), kept);
    await app.sheet.reload();
    await app.connected();
    await during(server, "weighs", async () => {
      await openMission(app, "weighs");
      const values = missionOf(app).getByRole("region", { name: "Watched values" });
      await values.getByText("12.5").waitFor();
    });
  },
);

const AXE = readFileSync(join(process.cwd(), "node_modules/axe-core/axe.min.js"), "utf8");

/** What axe finds wrong in mission control, in words. */
async function findings(app: App): Promise<readonly string[]> {
  await app.sheet.evaluate(AXE);
  return app.sheet.evaluate(async () => {
    interface Found {
      readonly id: string;
      readonly nodes: readonly { readonly target: readonly unknown[] }[];
    }
    const { axe } = window as unknown as {
      axe: { run: (place: string) => Promise<{ violations: readonly Found[] }> };
    };
    const { violations } = await axe.run(".mission");
    return violations.map(
      ({ id, nodes }) => `${id}: ${nodes.map(({ target }) => target.join(" "))}`,
    );
  });
}

/** What is too small for a finger, or sticks out to the side. */
async function unfit(app: App): Promise<readonly string[]> {
  return app.sheet.evaluate(() => {
    const place = document.querySelector(".mission");
    if (!place) return ["mission control is not there"];
    const edge = place.getBoundingClientRect().right + 0.5;
    const wide = document.documentElement.scrollWidth > window.innerWidth ? ["the page"] : [];
    const out = [...place.querySelectorAll("*")].filter(
      (part) => part.getBoundingClientRect().right > edge && !part.matches(".visually-hidden"),
    );
    const small = [...place.querySelectorAll("button, select, input")].filter((part) => {
      const { width, height } = (part.closest("label") ?? part).getBoundingClientRect();
      return !part.matches(".mission-event-where") && (height < 43.5 || width < 43.5);
    });
    const named = (part: Element) => `${part.tagName} ${part.className} ${part.textContent}`;
    const canvas = document.querySelector(".canvas-place")?.getBoundingClientRect();
    const panel = place.closest(".panel")?.getBoundingClientRect();
    const covered =
      canvas && panel && canvas.left < panel.right - 1 && canvas.top < panel.bottom - 1;
    return [...wide, ...(covered ? ["the canvas"] : []), ...out.map(named), ...small.map(named)];
  });
}

for (const colorScheme of ["dark", "light"] as const) {
  journey(
    `a ${colorScheme} tablet shows mission control for fingers, held either way`,
    {
      machines: MACHINES,
      open: "asks",
      browser: { colorScheme, hasTouch: true, viewport: { width: 1024, height: 768 } },
    },
    async ({ app, server }) => {
      await during(server, "asks", async () => {
        await openMission(app, "asks");
        const mission = missionOf(app);
        await mission.getByText("How heavy is the box, in kg?").waitFor();
        await expect.poll(() => unfit(app)).toEqual([]);
        expect(await findings(app)).toEqual([]);
        await app.sheet.setViewportSize({ width: 768, height: 1024 });
        await eventually(async () => ((await mission.boundingBox())?.width ?? 0) > 760);
        await eventually(async () => (await unfit(app)).length === 0);
        expect(await findings(app)).toEqual([]);
        await mission.getByRole("button", { name: "Cancel" }).tap();
        await mission.getByText("owner answered “Cancel: 0”").waitFor();
      });
    },
  );
}

/** True if a press at each corner of a button of mission control hits the button. */
async function atCorners(app: App, name: string): Promise<readonly boolean[]> {
  const button = missionOf(app).getByRole("button", { name, exact: true });
  return button.evaluate((found) => {
    const { left, right, top, bottom } = found.getBoundingClientRect();
    const xs = [left + 12, right - 12];
    const ys = [top + 4, bottom - 4];
    return xs.flatMap((x) => ys.map((y) => found.contains(document.elementFromPoint(x, y))));
  });
}

journey(
  "at 200 % Stop and Pause are whole, and the state of the run is below them",
  { machines: MACHINES, open: "drives", browser: { viewport: { width: 640, height: 360 } } },
  async ({ app, server }) => {
    await during(server, "drives", async () => {
      await openMission(app, "drives");
      await status(app).getByText("running").waitFor();
      for (const name of ["Stop", "Pause"])
        await expect.poll(() => atCorners(app, name)).toEqual([true, true, true, true]);
      const word = status(app);
      const isSeen = () =>
        word.evaluate((found) => {
          const { left, top, height } = found.getBoundingClientRect();
          return found.contains(document.elementFromPoint(left + 20, top + height / 2));
        });
      await expect.poll(isSeen).toBe(true);
    });
  },
);
