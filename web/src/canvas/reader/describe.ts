/** Descriptions of elements for screen readers: "Scan, execution state, 2 outcomes, leads to Search". */

import type { ElementRef } from "../../model/element.ts";
import {
  connectionInWords,
  isConnection,
  isPort,
  nameOf,
  transitionEnds,
} from "../../model/ends.ts";
import type { StateDocument } from "../../model/generated/protocol.ts";
import { type Machine, outcomesOf, portsOf, startOf, transitionsOf } from "../../model/machine.ts";
import { idOf, parentOf } from "../../model/path.ts";
import { KIND_WORDS } from "../../plan/legal.ts";
import type { MarkPhase, RunMark } from "../../store/run/marks.ts";

/** Signs of a state that its description includes. */
export interface Signs {
  /** Activity of the state in the run. */
  readonly run?: RunMark | undefined;
  readonly breakpoint?: "on" | "off" | undefined;
}

/** Description of an element. `signs` applies to states only. */
export function described(machine: Machine, element: ElementRef, signs: Signs = {}): string {
  const words = inWords(machine, element, signs);
  return words.length > WORDS_MAX ? `${words.slice(0, WORDS_MAX)}…` : words;
}

/** Maximum length of a description, in characters. */
const WORDS_MAX = 2_000;

function inWords(machine: Machine, element: ElementRef, signs: Signs): string {
  const state = machine.state(element.path);
  if (!state) return "no longer exists";
  if (element.kind === "state") return stateInWords(machine, element.path, state, signs);
  if (isConnection(element)) {
    const word = element.kind === "transition" ? "transition" : "data flow";
    return `${word} ${connectionInWords(machine, element)}`;
  }
  if (element.kind === "income") return `income of ${state.name}`;
  const name = nameOf(machine, element);
  if (!isPort(element)) return `outcome ${name} of ${state.name}`;
  const port = portsOf(state, element.kind).find(({ id }) => id === element.id);
  return `${element.kind.replace("_", " ")} ${name} of ${state.name}, type ${port?.data_type ?? "unknown"}`;
}

function stateInWords(
  machine: Machine,
  path: string,
  state: StateDocument,
  { run, breakpoint }: Signs,
): string {
  const kind = KIND_WORDS[state.kind];
  const children = machine.children(path).length;
  const own = outcomesOf(state).filter(({ id }) => id >= 0);
  const parts = [
    state.name,
    run ? runInWords(run) : "",
    breakpoint ? BREAKPOINT_WORDS[breakpoint] : "",
    kind,
    isStart(machine, path) ? "start state" : "",
    children > 0 && state.kind !== "library" ? several(children, "state") : "",
    several(own.length, "outcome"),
    leadsTo(machine, path),
  ];
  return parts.filter((part) => part !== "").join(", ");
}

/** Phases that start without a user action and may need attention at once. */
const URGENT: ReadonlySet<MarkPhase> = new Set(["waiting", "held", "next", "failed"]);

/** Announcement for a state that is selected while the run is active: "Scan waits for an answer". Empty if there is no reason for
 * one. */
export function urgentWords(machine: Machine, path: string, { run }: Signs): string {
  const name = machine.state(path)?.name;
  return name !== undefined && run && URGENT.has(run.phase) ? `${name} ${runInWords(run)}` : "";
}

const BREAKPOINT_WORDS = { on: "breakpoint", off: "breakpoint off" };

const RUN_WORDS: Readonly<Partial<Record<RunMark["phase"], string>>> = {
  running: "runs",
  waiting: "waits",
  held: "is paused",
  next: "comes next",
  preempted: "is being preempted",
  failed: "failed",
};

function runInWords({ phase, failed, detail }: RunMark): string {
  const word = RUN_WORDS[phase] ?? "";
  const whole = phase === "waiting" && detail !== null ? `waits for ${detail}` : word;
  return failed && phase !== "failed" ? `${whole}, failed before` : whole;
}

function several(count: number, word: string): string {
  return `${count} ${word}${count === 1 ? "" : "s"}`;
}

function isStart(machine: Machine, path: string): boolean {
  const parent = parentOf(path);
  const container = parent === null ? undefined : machine.state(parent);
  return container !== undefined && startOf(container)?.to_state === idOf(path);
}

function leadsTo(machine: Machine, path: string): string {
  const parent = parentOf(path);
  const container = parent === null ? undefined : machine.state(parent);
  if (parent === null || !container) return "";
  const names = new Set<string>();
  for (const transition of transitionsOf(container)) {
    if (transition.from_state !== idOf(path)) continue;
    const { to } = transitionEnds(parent, transition);
    names.add(
      to.kind === "income"
        ? nameOf(machine, { kind: "state", path: to.path })
        : endName(machine, to),
    );
  }
  return names.size === 0 ? "" : `leads to ${[...names].join(" and ")}`;
}

function endName(machine: Machine, to: ElementRef): string {
  return `outcome ${nameOf(machine, to)} of ${machine.state(to.path)?.name ?? to.path}`;
}
