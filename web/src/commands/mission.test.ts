import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { Control } from "../model/generated/protocol.ts";
import type { Watch } from "../store/run.ts";
import { silenceLeft } from "./mission.ts";
import { type Stand, stand } from "./stand.ts";

/** A run in front by this browser's clock, which is so far behind the server's. */
function controlled(control: Partial<Control>, ahead_ms = 0): Stand {
  const context = stand(`R "Root" hierarchy outcome done`);
  const all = { holder: "anna", since_ms: 0, heard_ms: 0, silence_ms: 0, requests: [], ...control };
  const watch = { id: "r", now: signal({ control: all }), moment: signal(null) };
  context.tab.run.value = watch as unknown as Watch;
  Object.assign(context.page.server, { pulse: signal({ ahead_ms }) });
  return context;
}

test("control can be taken over when its holder was silent, by the server's clock", () => {
  expect(silenceLeft(controlled({ holder: null }), 0)).toBe(0);
  expect(silenceLeft(controlled({ heard_ms: 1_000 }), 1_000)).toBe(0);
  expect(silenceLeft(controlled({ heard_ms: 2_000, silence_ms: 30_000 }, 500), 1_500)).toBe(33_000);
});

test("the holder may have been heard later than the server last told", () => {
  const context = controlled({ heard_ms: 10_000, silence_ms: 30_000 });
  expect(silenceLeft(context, 40_000)).toBe(3_000);
  expect(silenceLeft(context, 43_000)).toBe(0);
});
