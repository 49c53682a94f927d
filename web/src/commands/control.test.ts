import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { Control, Right } from "../model/generated/protocol.ts";
import type { Watch } from "../store/history/run.ts";
import { allCommands } from "./all.ts";
import { refusalOf } from "./command.ts";
import { silenceLeft } from "./control.ts";
import { type TestContext, testContext } from "./testing/context.ts";

/** A run in front; the last message of the server has this time of its clock. */
function controlled(
  control: Partial<Control>,
  server_ms = 0,
  answers: readonly boolean[] = [],
): TestContext {
  const context = testContext(`R "Root" hierarchy outcome done`, { answers });
  const all = { holder: "anna", since_ms: 0, heard_ms: 0, silence_ms: 0, requests: [], ...control };
  const watch = { id: "r", now: signal({ control: all }), playhead: signal(null) };
  context.tab.run.value = watch as unknown as Watch;
  Object.assign(context.page.server, { pulse: signal({ ahead_ms: -500, server_ms }) });
  return context;
}

test("control can be taken over when its holder was silent, by the server's clock", () => {
  expect(silenceLeft(controlled({ holder: null }))).toBe(0);
  expect(silenceLeft(controlled({ heard_ms: 1_000 }, 1_000))).toBe(0);
  expect(silenceLeft(controlled({ heard_ms: 2_000, silence_ms: 30_000 }, 2_000))).toBe(33_000);
});

test("the holder may have been heard later than the server last told", () => {
  const holder = { heard_ms: 10_000, silence_ms: 30_000 };
  expect(silenceLeft(controlled(holder, 40_000))).toBe(3_000);
  expect(silenceLeft(controlled(holder, 43_000))).toBe(0);
});

/** Which moves somebody may make now. */
function moves(control: Partial<Control>, rights: readonly Right[] = ["command"]): string {
  const context = controlled(control);
  const run = { id: "r", phase: "live" };
  const now = { ...context.tab.run.value?.now.value, run };
  const watch = { ...context.tab.run.value, now: signal(now) };
  context.tab.run.value = watch as unknown as Watch;
  const session = { user: "anna", role: "operator", rights };
  Object.assign(context.page.server, { link: signal({ state: "up", session, connection: 1 }) });
  const all = allCommands();
  const names = ["request", "withdraw", "accept", "decline", "hand-over", "release", "override"];
  return names
    .filter((name) => {
      const command = all.find(`control.${name}`);
      return command && refusalOf(command, context) === null;
    })
    .join(" ");
}

test("the holder hands over and releases, and withdraws what was offered", () => {
  expect(moves({ holder: "anna" })).toBe("hand-over release");
  expect(moves({ holder: "anna", offered_to: "bob" })).toBe("withdraw hand-over release");
});

test("who is offered control accepts or declines it, and no one else does", () => {
  expect(moves({ holder: "bob", offered_to: "anna" })).toBe("request accept decline");
  expect(moves({ holder: "bob", offered_to: "carl", requests: ["anna"] })).toBe("withdraw");
});

test("only an admin takes control from its holder, after a question", async () => {
  const rights = ["command", "administer"] as const;
  expect(moves({ holder: "bob" }, rights)).toBe("request override");
  expect(moves({ holder: null }, rights)).toBe("request");
  for (const [answer, taken] of [
    [false, []],
    [true, [{ move: "override" }]],
  ] as const) {
    const context = controlled({ holder: "bob" }, 0, [answer]);
    const made: unknown[] = [];
    const now = { ...context.tab.run.value?.now.value, run: { id: "r", name: "Drill" } };
    const watch = {
      ...context.tab.run.value,
      now: signal(now),
      control: (move: unknown) => made.push(move),
    };
    context.tab.run.value = watch as unknown as Watch;
    await allCommands().get("control.override")?.run(context, undefined);
    expect(made).toEqual(taken);
    expect(context.record).toEqual(["ask Take control from bob?"]);
  }
});
