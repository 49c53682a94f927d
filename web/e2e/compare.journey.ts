/** Runs that part on several branches: all are listed, the earliest first, and each leads to its place in both runs. */

import { expect } from "vitest";
import type { Comparison } from "../src/model/generated/protocol.ts";
import { journey } from "./support/journey.ts";
import { finished, shown, showsMoment } from "./support/time.ts";

journey(
  "each branch on which two runs part leads to its place in both",
  { open: "preemptive_with_timer" },
  async ({ app, server }) => {
    const found = await finished(server, "preemptive_with_timer");
    const late = await finished(server, "preemptive_with_timer", {
      inputs: { limit_s: 0.05, hidden_at_deg: 100_000 },
    });
    const what = `/runs/${late}/compare/${found}`;
    const { parted } = await server.ask<Comparison>("GET", what);
    const timer = parted.find(({ branch }) => branch.endsWith("/TIMERS"));
    const [first] = parted;
    if (!first?.one || !timer?.one || !timer.other) throw new Error("the branches do not part");
    await shown(app, late);
    await app.panel("Compare runs");
    await app.sheet.getByLabel("The other run").selectOption(found);
    const branches = app.sheet.getByRole("grid", { name: "Branches where the runs diverge" });
    await branches.getByText("first", { exact: true }).waitFor();
    expect(await branches.getByRole("row").count()).toBe(parted.length + 1);
    await branches.getByText("Timer ended with time is up").click();
    await showsMoment(app, timer.one.sequence);
    const sides = app.sheet.getByRole("button", { name: /^Runs diverge here/ });
    await expect
      .poll(() => sides.allTextContents())
      .toEqual([
        expect.stringContaining("Timer ended with time is up"),
        expect.stringContaining("Timer ended with preempted"),
      ]);
    await branches.getByText("first", { exact: true }).click();
    await showsMoment(app, first.one.sequence);
    await branches.getByText("Timer ended with time is up").click();
    await sides.last().click();
    await app.until(({ tab }, id) => tab?.run.value?.id === id, found);
    await showsMoment(app, timer.other.sequence);
  },
);
