import { expect, test } from "vitest";
import { RefusalError, type Server } from "../store/page/server.ts";
import { requestUntilAnswered } from "./request_until_answered.ts";
import { FakeClock } from "./testing/fake_clock.ts";

function setUp(answers: readonly (RefusalError | string)[]) {
  const sent: unknown[] = [];
  const left = [...answers];
  const request = async (_method: string, _path: string, body: unknown) => {
    sent.push(body);
    const answer = left.length > 1 ? left.shift() : left[0];
    if (answer instanceof RefusalError) throw answer;
    return answer;
  };
  const clock = new FakeClock();
  const server = { request: request as Server["request"] };
  return {
    sent,
    clock,
    answer: requestUntilAnswered<string>({ server, clock }, "/runs", { id: "a" }),
  };
}

async function settle(): Promise<void> {
  for (let turn = 0; turn < 20; turn += 1) await Promise.resolve();
}

const lost = new RefusalError({ code: "no_answer", message: "no answer" }, 0);
const unfinished = new RefusalError({ code: "not_finished", message: "ask again" }, 503);

test("an answer that was lost is asked for again, with the same id", async () => {
  const { sent, clock, answer } = setUp([lost, unfinished, "begun"]);
  for (let turn = 0; turn < 2; turn += 1) {
    await settle();
    clock.pass(500);
  }
  expect(await answer).toBe("begun");
  expect(sent).toEqual([{ id: "a" }, { id: "a" }, { id: "a" }]);
});

test("a refusal is one at once", async () => {
  const refusal = new RefusalError({ code: "load_failed", message: "no such library" }, 422);
  const { sent, answer } = setUp([refusal]);
  await expect(answer).rejects.toBe(refusal);
  expect(sent.length).toBe(1);
});

test("after a minute without an answer no one knows", async () => {
  const { clock, answer } = setUp([lost]);
  const rejection = expect(answer).rejects.toThrow(/it is unknown/);
  for (let turn = 0; turn < 121; turn += 1) {
    await settle();
    clock.pass(500);
  }
  await rejection;
});
