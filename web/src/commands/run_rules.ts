/** Permitted commands of a run, or the reasons against them: role, control and state of the run. */

import type { LinkRights, Right, RunStatus, Snapshot } from "../model/generated/protocol.ts";
import { runStatusWords } from "../model/run_words.ts";
import type { Watch } from "../store/history/run.ts";
import type { Page } from "../store/page/page.ts";
import { fileOfTab, liveRun, snapshotOf } from "../store/run/running.ts";
import type { CommandContext } from "./command.ts";
import { anyOnlyState } from "./subject.ts";

const NEEDED: Readonly<Partial<Record<Right, string>>> = {
  command:
    "only operators, engineers and admins may command runs: ask an admin for the role operator",
  start: "only operators, engineers and admins may start runs: ask an admin for the role operator",
  edit: "only engineers and admins may do this: ask an admin for the role engineer",
  administer: "only admins may do this",
};

/** Reason why the right is missing; null if the user has it. Commands wait while the server is not connected. */
export function lacks({ server }: Page, right: Right): string | null {
  const link = server.link.value;
  if (link.state !== "up" || link.session.rights.includes(right)) return null;
  return NEEDED[right] ?? `this needs the right to ${right}`;
}

const ALLOWED: Readonly<Record<LinkRights, string>> = {
  observe: "see runs",
  command: "see and command runs",
  change: "do everything",
};

/** Reason why the robot would refuse the right by its pairing with this station; null if it would not, or if that is
 * unknown. */
export function robotRefuses({ now }: Watch, right: Right): string | null {
  const { robot, rights } = now.value?.robot ?? {};
  if (rights === undefined || rights === null || rights === "change") return null;
  const needed = right === "edit" || right === "administer" ? "change" : "command";
  if (rights === needed) return null;
  return `${robot} lets users of this station only ${ALLOWED[rights]}: pair again with \`rafcon pair ${robot} --rights ${needed}\` on the robot`;
}

/** Reason why no run can be started. */
export function cannotStart({ page, tab }: CommandContext): string | null {
  if (!tab) return "open a machine first";
  if (page.server.link.value.state !== "up") return "there is no connection to the server";
  if (tab.session.fixed !== null && fileOfTab(tab) === null) {
    const robot = tab.run.value?.now.value?.run.robot;
    return robot
      ? `${robot} has the machine: use “Start again…” in the menu Run`
      : "the machine of this run is in no project";
  }
  return lacks(page, "start");
}

/** Another user in control of the run, if there is one. */
function otherHolder(page: Page, watch: Watch): string | null {
  const holder = watch.now.value?.control.holder ?? null;
  const link = page.server.link.value;
  const isOther = holder !== null && link.state === "up" && holder !== link.session.user;
  return isOther ? holder : null;
}

/** Reason why the current run cannot be commanded. With `rest`, for stop and pause, which need no control. */
export function cannotCommand(
  { page, tab }: CommandContext,
  { right = "command", rest = false }: { readonly right?: Right; readonly rest?: boolean } = {},
): string | null {
  const watch = tab?.run.value;
  if (!watch) return "no run is shown here: start one, or choose one";
  if (!liveRun(tab)) return overInWords(watch);
  const missing = lacks(page, "command") ?? lacks(page, right) ?? robotRefuses(watch, right);
  if (missing !== null) return missing;
  const other = otherHolder(page, watch);
  return other === null || rest ? null : `${other} is in control: ask for it in Mission control`;
}

function overInWords(watch: Watch): string {
  const now = watch.now.value;
  if (!now) return "the state of the run is not known yet";
  const { word } = runStatusWords(now);
  if (word === "crashed") return "the run crashed: resume it first, or start another";
  if (word === "diverged") return "this replica has diverged from the run at its robot";
  return word === "finished" ? "the run has ended: start another" : "the run did not start";
}

/** Reason why a command that needs one of these has no effect. */
export function cannotWhile(
  context: CommandContext,
  fits: readonly RunStatus[],
  rules?: Parameters<typeof cannotCommand>[1],
): string | null {
  const why = cannotCommand(context, rules);
  const snapshot = snapshotOf(context.tab?.run.value ?? null);
  if (why !== null) return why;
  if (!snapshot) return "the run is starting";
  return fits.includes(snapshot.status) ? null : notWhile(snapshot.status);
}

function notWhile(status: RunStatus): string {
  switch (status) {
    case "running":
      return "the run is not paused: pause it or turn on step mode";
    case "paused":
      return "the run is already paused";
    case "stepping":
      return "the run is in step mode: use Resume to continue";
    case "stopping":
      return "the run is being stopped";
    case "finished":
      return "the run has ended";
  }
}

/** True if a branch is paused and can be stepped. */
export function isHeld({ active }: Snapshot): boolean {
  return active.some(({ held }) => held.length > 0);
}

/** The path that a command is meant for: the one given, else the selected state. */
export function pathFor(context: CommandContext, path: string | undefined): string | null {
  return path ?? anyOnlyState(context)?.path ?? null;
}

/** Reason why the selection is not a single state. */
export const NO_STATE = "select one state first";
