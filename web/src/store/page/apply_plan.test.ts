import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { Edit } from "../../model/generated/protocol.ts";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import type { EditAnswer } from "../document/machine_session.ts";
import { type AppliedPlan, applyPlan, unshownEdit } from "./apply_plan.ts";
import { newView } from "./view.ts";

const EDIT = { edit: "batch", edits: [] } as Edit;
const [BEFORE, AFTER] = ["R hierarchy\n  A execution", "R hierarchy\n  A execution\n  B execution"];

interface Given {
  readonly plan?: AppliedPlan;
  readonly rights?: readonly string[];
  readonly fixed?: string | null;
  readonly selection?: "set" | "keep";
  readonly answer?: EditAnswer;
}

/** Result and selection, before and after the answer with which state B appears. */
async function applied(given: Given): Promise<string> {
  const { rights = ["edit"], fixed = null, selection, answer = { revision: 1 } } = given;
  const plan = given.plan ?? {
    name: "Add B",
    edit: EDIT,
    select: [{ kind: "state", path: "R/B" }],
  };
  let answered: (answer: EditAnswer) => void = () => {};
  const session = {
    fixed,
    machine: machineOf(sketch(BEFORE)),
    named: (text: string) => text,
    edit: () => new Promise<EditAnswer>((done) => (answered = done)),
  };
  const view = newView();
  const page = { server: { link: signal({ state: "up", session: { rights } }) } };
  const made = applyPlan(page as never, { session, view } as never, plan, selection);
  if (typeof made === "string") return `refused: ${made}`;
  const before = [...view.selection.value].join();
  session.machine = machineOf(sketch(AFTER));
  answered(answer);
  await unshownEdit(session as never);
  return `[${before}] ${(await made) ?? "done"} [${[...view.selection.value].join()}]`;
}

test("an edit is sent with the rights to edit only, and never to a fixed machine", async () => {
  expect(await applied({ rights: [] })).toMatch(/^refused: You can view this machine/);
  expect(await applied({ fixed: "The run used it." })).toBe("refused: The run used it.");
  expect(await applied({ plan: { refused: "No room." } })).toBe("refused: No room.");
});

test("the result is selected when it is visible, and not after a refusal by the server", async () => {
  expect(await applied({})).toBe("[] done [state:R/B]");
  const visible = { name: "Rename", edit: EDIT, select: [{ kind: "state" as const, path: "R/A" }] };
  expect(await applied({ plan: visible })).toBe("[state:R/A] done [state:R/A]");
  expect(await applied({ answer: { refused: "Gone." } })).toBe("[] Gone. []");
});

test("the selection is kept where the caller wants that", async () => {
  expect(await applied({ selection: "keep" })).toBe("[] done []");
});
