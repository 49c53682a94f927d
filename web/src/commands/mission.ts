/** Commands of mission control: answers to questions, and acknowledgements. */

import { effect } from "@preact/signals-core";
import type { JsonValue, Question } from "../model/generated/protocol.ts";
import { answeredBy } from "../store/history/questions.ts";
import type { Watch } from "../store/history/run.ts";
import { type Page, runOf } from "../store/page/page.ts";
import { acknowledge, openFailures } from "../store/run/acknowledged.ts";
import type { CommandContext, UserCommand } from "./command.ts";
import { cannotCommand } from "./run_rules.ts";
import { failureOf } from "./send_command.ts";

/** The layout for operators, and the panel in it. */
export const MISSION_LAYOUT = "Mission control";
export const MISSION_PANEL = "mission" as const;

export const MISSION: readonly UserCommand[] = [
  {
    id: "mission.open",
    title: "Mission control",
    detail: "Shows the mission at a glance: questions, branches, events, the user in control.",
    keys: ["Ctrl+Alt+M"],
    menu: "View/4",
    run: ({ shell }) => {
      shell.layouts.apply(MISSION_LAYOUT);
      shell.showPanel(MISSION_PANEL);
      shell.overview();
    },
  },
  {
    id: "mission.show",
    title: "Show what needs attention",
    detail: "Shows mission control in any layout.",
    run: async ({ page, shell }, argument) => {
      if (argument) await toRun(page, argument);
      shell.showPanel(MISSION_PANEL);
    },
  },
  {
    id: "mission.acknowledge",
    title: "Acknowledge all events",
    detail: "Marks the failures and warnings of the current run as seen.",
    enabled: ({ tab }) => {
      const watch = tab?.run.value;
      return watch != null && openFailures(watch).value.length > 0;
    },
    run: ({ tab }, argument) => {
      const watch = tab?.run.peek();
      if (!watch) return;
      const all = openFailures(watch).peek();
      const sequences = argument !== undefined ? [argument] : all.map(sequenceOf);
      acknowledge(watch, sequences);
    },
  },
  {
    id: "run.answer",
    title: "Answer a question",
    refusal: (context) => cannotCommand(context),
    run: (context, argument) => {
      if (argument === undefined) return context.shell.showPanel(MISSION_PANEL);
      const { question, value } = argument;
      return answer(context, question, value);
    },
  },
];

/** Time in which the answer of another user may arrive, in ms. */
const OTHERS_MS = 1_000;

/** Only the first answer counts. The user of a later one reads who was first instead of the reason of a refusal. */
async function answer(
  { page, tab }: CommandContext,
  question: Question,
  value: JsonValue,
): Promise<void> {
  const watch = tab?.run.peek();
  if (!watch) return;
  const sent = await watch.command({ type: "answer_question", question: question.id, value });
  const why = failureOf(sent);
  if (why === null) return;
  const other = await otherAnswer(watch, question.id);
  const text =
    other === null ? `Your answer: ${why}` : `${other} has answered “${question.message}”`;
  page.tell({ level: other === null ? "warning" : "info", text, isQuiet: true });
}

function otherAnswer(watch: Watch, question: number): Promise<string | null> {
  return new Promise((found) => {
    const timer = setTimeout(() => found(null), OTHERS_MS);
    const stop = effect(() => {
      const other = answeredBy(watch, question);
      if (other === null) return;
      clearTimeout(timer);
      found(other);
    });
    setTimeout(stop, OTHERS_MS);
  });
}

/** The tab that shows the run, or the one for runs of its machine. */
async function toRun(page: Page, run: string): Promise<void> {
  if (runOf(page)?.id === run) return;
  const there = page.tabs.peek().find((tab) => tab.run.peek()?.id === run);
  if (there) page.active.value = there;
  else await page.showRun(run);
}

function sequenceOf({ sequence }: { readonly sequence: number }): number {
  return sequence;
}
