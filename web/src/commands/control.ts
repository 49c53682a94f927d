/** Commands for the control of the current run. */

import type { Control, ControlMove } from "../model/generated/protocol.ts";
import { sessionOfPage, summaryOf } from "../store/run/running.ts";
import type { CommandChoice, CommandContext, UserCommand } from "./command.ts";
import { cannotCommand, lacks } from "./run_rules.ts";

export const CONTROL: readonly UserCommand[] = [
  {
    id: "control.request",
    title: "Ask for control",
    detail: "Asks the user in control. If nobody is in control, you get it at once.",
    refusal: (context) => refusalOfMove(context, "request"),
    run: (context) => move(context, { move: "request" }),
  },
  {
    id: "control.withdraw",
    title: "Withdraw your request or offer of control",
    refusal: (context) => refusalOfMove(context, "withdraw"),
    run: (context) => move(context, { move: "withdraw" }),
  },
  {
    id: "control.accept",
    title: "Accept control",
    detail: "The user in control offers it to you.",
    refusal: (context) => refusalOfMove(context, "accept"),
    run: (context) => move(context, { move: "accept" }),
  },
  {
    id: "control.decline",
    title: "Decline control",
    detail: "The user in control keeps it.",
    refusal: (context) => refusalOfMove(context, "decline"),
    run: (context) => move(context, { move: "decline" }),
  },
  {
    id: "control.hand-over",
    title: "Hand control over",
    detail: "A user who asked gets it at once; anyone else must accept it first.",
    refusal: (context) => refusalOfMove(context, "hand_over"),
    choices: askers,
    run: (context, argument) => handOver(context, argument),
  },
  {
    id: "control.release",
    title: "Release control",
    detail: "The first user who asked gets it, or the next to give a command.",
    refusal: (context) => refusalOfMove(context, "release"),
    run: (context) => move(context, { move: "release" }),
  },
  {
    id: "control.take-over",
    title: "Take control over",
    detail: "From a user who has been silent for a while.",
    refusal: (context) => refusalOfMove(context, "take_over"),
    run: (context) => move(context, { move: "take_over" }),
  },
  {
    id: "control.override",
    title: "Take control from its holder…",
    detail: "Takes control from anyone at once. Admins only; recorded.",
    refusal: (context) => refusalOfMove(context, "override"),
    run: override,
  },
];

async function move({ tab }: CommandContext, wanted: ControlMove): Promise<void> {
  await tab?.run.peek()?.control(wanted);
}

async function handOver({ tab, shell }: CommandContext, argument?: string): Promise<void> {
  const watch = tab?.run.peek();
  const to =
    argument ??
    (await shell.prompt({
      title: "Hand control over",
      label: "User",
      check: (text) => (text.trim() === "" ? "Hands control to a user." : null),
    }));
  if (to) await watch?.control({ move: "hand_over", to: to.trim() });
}

/** A holder who is at work loses control in the middle of it: that is asked about first. */
async function override({ page, tab, shell }: CommandContext): Promise<void> {
  const watch = tab?.run.peek();
  const holder = watch?.now.peek()?.control.holder;
  if (!watch || !holder) return;
  const name = summaryOf(page, watch)?.name ?? watch.id;
  const isSure = await shell.confirm({
    title: `Take control from ${holder}?`,
    text: `${holder} is in control of “${name}” and loses it at once. The run's history records that you took it.`,
    yes: "Take control",
    danger: true,
  });
  if (isSure) await watch.control({ move: "override" });
}

function askers({ tab }: CommandContext): readonly CommandChoice<string>[] {
  const requests = tab?.run.value?.now.value?.control.requests ?? [];
  return requests.map((user) => ({ title: user, detail: "asks for control", argument: user }));
}

/** Reason why control cannot be passed this way; null if it can. */
function refusalOfMove(context: CommandContext, wanted: ControlMove["move"]): string | null {
  const why = cannotCommand(context, { rest: true });
  const control = context.tab?.run.value?.now.value?.control;
  const session = sessionOfPage(context.page);
  if (why !== null || !control) return why ?? "it is not known yet who is in control";
  if (!session) return "there is no connection to the server";
  const isMine = control.holder === session.user;
  return isMine ? ofHolder(control, wanted) : ofOther(context, control, session.user, wanted);
}

/** Restrictions of the user in control. */
function ofHolder({ offered_to }: Control, wanted: ControlMove["move"]): string | null {
  switch (wanted) {
    case "hand_over":
    case "release":
      return null;
    case "withdraw":
      return offered_to === undefined ? "you have not offered control" : null;
    default:
      return "you are in control";
  }
}

/** Restrictions of other users. */
function ofOther(
  context: CommandContext,
  { holder, requests, offered_to }: Control,
  user: string,
  wanted: ControlMove["move"],
): string | null {
  const asks = requests.includes(user);
  switch (wanted) {
    case "request":
      return asks ? "you have already asked for control" : null;
    case "withdraw":
      return asks ? null : "you have not asked for control";
    case "accept":
    case "decline":
      return offered_to === user ? null : "nobody has offered you control";
    case "override":
      return holder === null ? "nobody is in control" : lacks(context.page, "administer");
    case "take_over":
      return stillHeard(context);
    case "hand_over":
    case "release":
      return "only the user in control can hand it over";
  }
}

/** The server reports a present holder once in this fraction of the silence, so the holder may have been heard that much later. */
const UNTOLD = 1 / 10;

/** Time until control can be taken over from its holder, in ms; 0: now. Silence of the server is no silence of the holder. */
export function silenceLeft({ page, tab }: CommandContext): number {
  const control = tab?.run.value?.now.value?.control;
  if (!control || control.holder === null) return 0;
  const there_ms = page.server.pulse.value?.server_ms ?? 0;
  const heardTill_ms = control.heard_ms + control.silence_ms * UNTOLD;
  return Math.max(0, heardTill_ms + control.silence_ms - there_ms);
}

function stillHeard(context: CommandContext): string | null {
  const left_ms = silenceLeft(context);
  if (left_ms === 0) return null;
  const holder = context.tab?.run.value?.now.value?.control.holder;
  return `${holder} is still active: ask for control, or wait until ${holder} has been silent for longer`;
}
