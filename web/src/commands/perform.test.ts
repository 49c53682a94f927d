import { expect, test } from "vitest";
import type { EditAnswer } from "../store/document/machine_session.ts";
import { select } from "../store/page/view.ts";
import { ARRANGE } from "./arrange.ts";
import { testContext } from "./testing/context.ts";

const GROUP = ARRANGE.find(({ id }) => id === "arrange.group");

async function settle(): Promise<void> {
  for (let turn = 0; turn < 20; turn += 1) await Promise.resolve();
}

test("a hurried second command waits for what the first one makes, instead of naming what is gone", async () => {
  const context = testContext("R hierarchy\n  A execution", { selected: ["state:R/A"] });
  const { session, view } = context.tab;
  const answers: ((answer: EditAnswer) => void)[] = [];
  const sent: string[] = [];
  Object.assign(session, {
    edit: (name: string) => {
      sent.push(name);
      return new Promise<EditAnswer>((answer) => answers.push(answer));
    },
  });
  void GROUP?.run(context, undefined);
  void GROUP?.run(context, undefined);
  await settle();
  expect(sent).toEqual(["Group A"]);
  select(view, []);
  answers[0]?.({ revision: 2 });
  await settle();
  expect(sent).toEqual(["Group A"]);
  expect(context.record.at(-1)).toMatch(/^tell /);
});
