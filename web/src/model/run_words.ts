/** Status of a run in words for people: one word with its details. */

import type {
  ActiveState,
  HeldBy,
  Loss,
  RunNow,
  RunSummary,
  Snapshot,
} from "./generated/protocol.ts";
import { ABORTED, PREEMPTED } from "./machine.ts";

export type RunWord =
  | "starting"
  | "running"
  | "waiting"
  | "paused"
  | "stepping"
  | "stopping"
  | "finished"
  | "crashed"
  | "diverged"
  | "not started"
  | "unreadable";

/** Colour of the word, which adds no information. */
type RunTone = "running" | "waiting" | "held" | "aborted" | "preempted" | "plain";

export interface RunStatusWords {
  readonly word: RunWord;
  readonly tone: RunTone;
  /** Outcome or reason; empty if there is none. */
  readonly detail: string;
}

/** True in the phases of an active run. */
export function isLive(phase: RunSummary["phase"] | undefined): boolean {
  return phase === "live" || phase === "starting";
}

/** Status of a run from its summary. */
export function summaryStatusWords(run: RunSummary): RunStatusWords {
  switch (run.phase) {
    case "starting":
      return { word: "starting", tone: "plain", detail: "" };
    case "live":
      return waitingStatusWords(run);
    case "finished":
      return { word: "finished", tone: outcomeTone(run.outcome.id), detail: run.outcome.name };
    case "crashed":
      return { word: "crashed", tone: "aborted", detail: "" };
    case "diverged":
      return { word: "diverged", tone: "aborted", detail: "from its robot" };
    case "not_started":
      return { word: "not started", tone: "aborted", detail: run.reason };
    case "unreadable":
      return { word: "unreadable", tone: "aborted", detail: run.reason };
  }
}

/** Status of a live run, with the reason if it waits. */
function waitingStatusWords({ waits }: RunSummary): RunStatusWords {
  switch (waits) {
    case "answer":
      return waitingFor(AN_ANSWER);
    case "decision":
      return UNDECIDED;
    case "paused":
      return { word: "paused", tone: "held", detail: "" };
    case "other":
      return waitingFor("");
    default:
      return { word: "running", tone: "running", detail: "" };
  }
}

function waitingFor(what: string): RunStatusWords {
  return { word: "waiting", tone: "waiting", detail: what === "" ? "" : `for ${what}` };
}

/** Reason for waiting of a script with an open question. */
export const AN_ANSWER = "an answer";

const UNDECIDED: RunStatusWords = {
  word: "waiting",
  tone: "waiting",
  detail: "for a decision after the crash",
};

/** Status of a run from its full state. */
export function runStatusWords(now: RunNow): RunStatusWords {
  const { run, snapshot } = now;
  if (run.phase !== "live" || !snapshot) return summaryStatusWords(run);
  const held = heldInWords(snapshot.active);
  const isUndecided = snapshot.active.some(({ phase }) => phase === "interrupted");
  if (isUndecided && snapshot.status !== "stopping") return UNDECIDED;
  switch (snapshot.status) {
    case "running":
      return runningStatusWords(snapshot);
    case "paused":
      return { word: "paused", tone: "held", detail: snapshot.journal_problem ?? held };
    case "stepping":
      return { word: isHeldByLoss(snapshot) ? "paused" : "stepping", tone: "held", detail: held };
    case "stopping":
      return { word: "stopping", tone: "preempted", detail: "" };
    case "finished":
      return { word: "finished", tone: "plain", detail: "" };
  }
}

/** A run waits if none of its branches is working. A script with an open question counts as waiting. */
function runningStatusWords({ active, questions }: Snapshot): RunStatusWords {
  const asks = new Set(questions.map(({ path }) => path));
  const atWork = leaves(active).filter(
    ({ phase, path }) => phase === "preempted" || (phase === "running" && !asks.has(path)),
  );
  const [first] = active.filter(({ phase }) => phase === "waiting");
  if (atWork.length > 0 || (asks.size === 0 && !first)) {
    return { word: "running", tone: "running", detail: "" };
  }
  return waitingFor(asks.size > 0 ? AN_ANSWER : (first?.detail ?? ""));
}

function leaves(active: readonly ActiveState[]): readonly ActiveState[] {
  return active.filter(({ path }) => !active.some((other) => other.path.startsWith(`${path}/`)));
}

function outcomeTone(id: number): RunTone {
  if (id === ABORTED) return "aborted";
  return id === PREEMPTED ? "preempted" : "plain";
}

/** True if a lost-link policy holds a branch. The branch stays paused until somebody resumes it, even after the link is back. */
export function isHeldByLoss({ active }: Snapshot): boolean {
  return active.some(({ held }) => held.some(({ by }) => by.type === "loss"));
}

/** Reasons why the run is held, each once; empty if it is not held, or only by a pause or a step. */
function heldInWords(active: readonly ActiveState[]): string {
  const all = active.flatMap(({ held }) => held.map(({ by }) => by));
  const found = all.filter(({ type }) => type !== "step" && type !== "pause");
  return [...new Set(found.map(reasonOfHold))].join(", ");
}

/** Reason for a hold, to follow a word such as `paused`: `breakpoint 3`. Empty for a pause by a user. */
export function reasonOfHold(by: HeldBy): string {
  switch (by.type) {
    case "pause":
      return "";
    case "step":
      return "step finished";
    case "run_to":
      return "target state reached";
    case "breakpoint":
      return `breakpoint ${by.id}`;
    case "start":
      return "start of the run";
    case "loss":
      return LOSS_WORDS[by.loss];
  }
}

/** Cause of a hold by a lost-link policy, and the remedy. */
export const LOSS_WORDS: Readonly<Record<Loss, string>> = {
  link: "no signal from the ground; resume to continue",
  command: "nobody gave a command; resume to continue",
};

/** A hold with its cause: `paused by breakpoint 3`. */
export function holdInWords(by: HeldBy): string {
  switch (by.type) {
    case "pause":
      return "paused";
    case "step":
      return "paused after a step";
    case "run_to":
      return "paused at the target state";
    case "breakpoint":
      return `paused by breakpoint ${by.id}`;
    case "start":
      return "paused at the start";
    case "loss":
      return `paused: ${LOSS_WORDS[by.loss]}`;
  }
}

/** `finished: success`. */
export function statusInWords({ word, detail }: RunStatusWords): string {
  if (detail === "") return word;
  return word === "waiting" ? `${word} ${detail}` : `${word}: ${detail}`;
}
