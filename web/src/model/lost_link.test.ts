import { expect, test } from "vitest";
import type { JsonValue } from "./generated/protocol.ts";
import { ownPolicy, policyInWords, withPolicy } from "./lost_link.ts";

function words(data: JsonValue): string {
  const policy = ownPolicy(data, "link");
  return policy === null || policy === "unclear" ? String(policy) : policyInWords(policy);
}

test("a policy is read as the engine reads it", () => {
  expect(words({ lost_link: "continue" })).toBe("continue");
  expect(words({ lost_link: { finish_s: "0.5", hold_s: 600, recover_s: 3600 } })).toBe(
    "finish and pause after 0.5 s, pause after 600 s, recover after 3600 s",
  );
  expect(words({ lost_command: { hold_s: 30 } })).toBe("null");
});

test("what is no policy is not half understood", () => {
  for (const nonsense of [
    {},
    30,
    null,
    "hold",
    { hold_s: "soon" },
    { hold_s: "" },
    { hold_s: -1 },
    { hold_s: 30, wait_s: 30 },
  ]) {
    expect(words({ lost_link: nonsense })).toBe("unclear");
  }
});

test("a policy is written beside the other data, and removed again", () => {
  const data = { note: "drill", lost_command: "continue" };
  const held = withPolicy(data, "link", { hold_s: 30 });
  expect(held).toEqual({ ...data, lost_link: { hold_s: 30 } });
  expect(withPolicy(held, "link", {})).toEqual({ ...data, lost_link: "continue" });
  expect(withPolicy(held, "link", null)).toEqual(data);
  expect(withPolicy(null, "command", { recover_s: 5 })).toEqual({
    lost_command: { recover_s: 5 },
  });
});
