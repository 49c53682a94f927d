/** Events of a run as text: type, state and outcome. */

import type { Event } from "../../model/generated/protocol.ts";
import { idOf, lineage } from "../../model/path.ts";
import { perOwner } from "../../model/per_owner.ts";
import { LOSS_WORDS } from "../../model/run_words.ts";
import type { MachineSession } from "../../store/document/machine_session.ts";
import type { JournalEntry } from "../../store/history/journal.ts";

export type NameOf = (path: string) => string;

/** Libraries with requested content, whose states need names. */
const askedOf = perOwner((_session: MachineSession) => new Set<string>());

/** Names of states of a machine. A deleted state has its id. Content of a library is requested, and has its id until it is loaded. */
export function namesOf(session: MachineSession): NameOf {
  return (path) => {
    const state = session.machine.state(path);
    if (!state) askFor(session, path);
    return state?.name ?? idOf(path);
  };
}

function askFor(session: MachineSession, path: string): void {
  const library = lineage(path).findLast(
    (outer) => session.machine.state(outer)?.kind === "library",
  );
  if (library === undefined) return;
  const asked = askedOf(session);
  if (asked.has(library)) return;
  asked.add(library);
  void session.loadLibrary(library);
}

/** Such as `Look entered`, `Look ended with seen`, `Look: careful`. */
export function happenedInWords(entry: JournalEntry, nameOf: NameOf): string {
  if (entry.kind === "other") return eventInWords(entry.event, nameOf);
  const name = nameOf(entry.path);
  if (entry.kind === "entered") return `${name} entered${entry.isBack ? " backwards" : ""}`;
  if (entry.isBack) return `${name} undone`;
  return `${name} ended with ${entry.outcome?.name ?? "nothing"}`;
}

function eventInWords(event: Event, nameOf: NameOf): string {
  switch (event.type) {
    case "log":
      return event.path === "" ? event.message : `${nameOf(event.path)}: ${event.message}`;
    case "hit":
      return `Breakpoint at ${nameOf(event.path)} ${event.held ? "paused" : "passed"}`;
    case "held":
      return `${nameOf(event.path)} paused${event.next ? ` before ${nameOf(event.next)}` : ""}`;
    case "commanded":
      return commandInWords(
        event.envelope.command.type,
        event.envelope.author,
        event.answer.answer,
      );
    case "asked":
      return `${nameOf(event.question.path)} asks: ${event.question.message}`;
    case "closed":
      return `Question ${event.id} ${event.how.replace("_", " ")}`;
    case "resumed":
      return `Resumed after a crash: ${event.crash.reason}`;
    case "went_back":
      return "The run restarted at an earlier moment";
    case "forced":
      return `${nameOf(event.path)} was forced to end with ${event.outcome.name}`;
    case "deadline_passed":
      return `${nameOf(event.path)} missed its deadline`;
    case "loss_recovery":
      return `${nameOf(event.path)} gives way to its recovery: ${LOSS_WORDS[event.loss]}`;
    case "silence":
      return silenceInWords(event);
    case "finished":
      return `The run ended with ${event.outcome.name}`;
    case "paused":
      return event.paused ? "Paused" : "Resumed";
    case "stopping":
      return "Stopping";
    case "root":
      return event.change === ""
        ? "The machine was loaded"
        : `The machine changed: ${event.change}`;
    case "waiting":
      return `${nameOf(event.path)} waits: ${event.reason}`;
    case "damaged":
      return `Events ${event.first} to ${event.last} cannot be read: the journal is damaged`;
    case "dropped":
      return `${nameOf(event.path)} dropped`;
    case "cut_off":
      return `${nameOf(event.path)} was cut off`;
    case "scoped":
      return `${nameOf(event.path)}: ${event.name} changed`;
    case "global":
      return `Global ${event.name} changed`;
    default:
      return event.type.replaceAll("_", " ");
  }
}

function commandInWords(type: string, author: string, answer: string): string {
  const what = type.replaceAll("_", " ");
  const who = author === "" ? "" : ` by ${author}`;
  return `Command ${what}${who}${answer === "applied" ? "" : ` (${answer})`}`;
}

/** Text about the silence of the ground. A time of 0 means that there is no silence. */
function silenceInWords({ link_ms, command_ms }: { link_ms: number; command_ms: number }): string {
  const link = `No signal from the ground for ${link_ms / 1000} s`;
  const command = `nobody has given a command for ${command_ms / 1000} s`;
  if (link_ms > 0) return command_ms > 0 ? `${link}, ${command}` : link;
  return command_ms > 0 ? `Receiving from the ground, ${command}` : "Receiving from the ground";
}
