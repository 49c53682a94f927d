/** What mission control does beside steering a run: who is in control, answers to questions, what was seen by a human. */

import { effect } from "@preact/signals-core";
import type { ControlMove, JsonValue, Question } from "../model/generated/protocol.ts";
import { acknowledge, openFailures } from "../store/acknowledged.ts";
import { type Page, runOf } from "../store/page.ts";
import { answeredBy } from "../store/questions.ts";
import type { Watch } from "../store/run.ts";
import { sessionOfPage } from "../store/running.ts";
import type { Choice, Command, Context } from "./command.ts";
import { failureOf } from "./give.ts";
import { cannotCommand } from "./run_rules.ts";

/** The layout for operators, and the panel in it. */
export const MISSION_LAYOUT = "Mission control";
export const MISSION_PANEL = "mission";

/** What `run.answer` needs to be told. */
export interface Answering {
  readonly question: Question;
  readonly value: JsonValue;
}

export const MISSION: readonly Command[] = [
  {
    id: "mission.open",
    title: "Mission control",
    detail: "How the mission stands, in large: questions, branches, events, who is in control.",
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
    title: "Show what wants a human",
    detail: "Brings mission control into sight, in whatever layout.",
    run: async ({ page, shell }, argument) => {
      if (typeof argument === "string") await toRun(page, argument);
      shell.showPanel(MISSION_PANEL);
    },
  },
  {
    id: "mission.acknowledge",
    title: "Acknowledge all events",
    detail: "Failures and warnings of the run in front were seen.",
    enabled: ({ tab }) => {
      const watch = tab?.run.value;
      return watch != null && openFailures(watch).value.length > 0;
    },
    run: ({ tab }, argument) => {
      const watch = tab?.run.peek();
      if (!watch) return;
      const all = openFailures(watch).peek();
      const sequences = typeof argument === "number" ? [argument] : all.map(sequenceOf);
      acknowledge(watch, sequences);
    },
  },
  {
    id: "run.answer",
    title: "Answer a question",
    refusal: (context) => cannotCommand(context),
    run: (context, argument) => {
      if (argument === undefined) return context.shell.showPanel(MISSION_PANEL);
      const { question, value } = argument as Answering;
      return answer(context, question, value);
    },
  },
  {
    id: "control.request",
    title: "Ask for control",
    detail: "Who is in control is told that you want it; if nobody is, you get it at once.",
    refusal: (context) => refusalOfMove(context, "request"),
    run: (context) => move(context, { move: "request" }),
  },
  {
    id: "control.withdraw",
    title: "Ask no more for control",
    refusal: (context) => refusalOfMove(context, "withdraw"),
    run: (context) => move(context, { move: "withdraw" }),
  },
  {
    id: "control.hand-over",
    title: "Hand control over",
    refusal: (context) => refusalOfMove(context, "hand_over"),
    choices: askers,
    run: (context, argument) => handOver(context, argument),
  },
  {
    id: "control.release",
    title: "Release control",
    detail: "Who asked first gets it; if nobody did, whoever commands next.",
    refusal: (context) => refusalOfMove(context, "release"),
    run: (context) => move(context, { move: "release" }),
  },
  {
    id: "control.take-over",
    title: "Take control over",
    detail: "From somebody who was not heard for a while.",
    refusal: (context) => refusalOfMove(context, "take_over"),
    run: (context) => move(context, { move: "take_over" }),
  },
];

/** So long the answer of somebody else may be on its way. */
const OTHERS_MS = 1_000;

/** Of two answers one counts: who came too late is told who was first, and not why a command is refused. */
async function answer({ page, tab }: Context, question: Question, value: JsonValue): Promise<void> {
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

/** Where the run is shown already, else where runs of its machine are. */
async function toRun(page: Page, run: string): Promise<void> {
  if (runOf(page)?.id === run) return;
  const there = page.tabs.peek().find((tab) => tab.run.peek()?.id === run);
  if (there) page.active.value = there;
  else await page.showRun(run);
}

function sequenceOf({ sequence }: { readonly sequence: number }): number {
  return sequence;
}

async function move({ tab }: Context, wanted: ControlMove): Promise<void> {
  await tab?.run.peek()?.control(wanted);
}

async function handOver({ tab, shell }: Context, argument: unknown): Promise<void> {
  const watch = tab?.run.peek();
  const to =
    typeof argument === "string"
      ? argument
      : await shell.prompt({
          title: "Hand control over",
          label: "To the user",
          check: (text) => (text.trim() === "" ? "Control is handed over to somebody." : null),
        });
  if (to) await watch?.control({ move: "hand_over", to: to.trim() });
}

function askers({ tab }: Context): readonly Choice[] {
  const requests = tab?.run.value?.now.value?.control.requests ?? [];
  return requests.map((user) => ({ title: user, detail: "asks for it", argument: user }));
}

/** Why control cannot be moved so; null if it can. */
function refusalOfMove(context: Context, wanted: ControlMove["move"]): string | null {
  const why = cannotCommand(context, { rest: true });
  const control = context.tab?.run.value?.now.value?.control;
  const session = sessionOfPage(context.page);
  if (why !== null || !control) return why ?? "who is in control is not known yet";
  if (!session) return "there is no connection to the server";
  const [isMine, asks] = [control.holder === session.user, control.requests.includes(session.user)];
  switch (wanted) {
    case "request":
      return isMine ? "you are in control" : asks ? "you have asked for it" : null;
    case "withdraw":
      return asks ? null : "you have not asked for it";
    case "hand_over":
    case "release":
      return isMine ? null : "only who is in control can give it away";
    case "take_over":
      return isMine ? "you are in control" : stillHeard(context);
  }
}

/** The server tells of a holder who goes on being heard once in this part of the silence: they may have been heard so much later. */
const UNTOLD = 1 / 10;

/** So long nobody can take control over from its holder, in ms; 0: anybody may. */
export function silenceLeft({ page, tab }: Context, now_ms: number): number {
  const control = tab?.run.value?.now.value?.control;
  if (!control || control.holder === null) return 0;
  const there_ms = now_ms + (page.server.pulse.value?.ahead_ms ?? 0);
  const heardTill_ms = control.heard_ms + control.silence_ms * UNTOLD;
  return Math.max(0, heardTill_ms + control.silence_ms - there_ms);
}

function stillHeard(context: Context): string | null {
  const left_ms = silenceLeft(context, Date.now());
  if (left_ms === 0) return null;
  const holder = context.tab?.run.value?.now.value?.control.holder;
  return `${holder} was heard lately: ask for control, or wait until ${holder} has been silent for long`;
}
