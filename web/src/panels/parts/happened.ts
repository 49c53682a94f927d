/** An event of a run in words, for people: what, of which state, how it ended. */

import type { Event } from "../../model/generated/protocol.ts";
import type { Machine } from "../../model/machine.ts";
import { idOf } from "../../model/path.ts";
import type { Happening } from "../../store/journal.ts";

export type NameOf = (path: string) => string;

/** The name of a state of a machine; its id, if the machine has it no more. */
export function namesIn(machine: Machine): NameOf {
  return (path) => machine.state(path)?.name ?? idOf(path);
}

/** `Look entered`, `Look ended by seen`, `Look: careful`. */
export function happenedInWords(happening: Happening, nameOf: NameOf): string {
  if (happening.kind === "other") return eventInWords(happening.event, nameOf);
  const name = nameOf(happening.path);
  if (happening.kind === "entered") return `${name} entered${happening.isBack ? " backwards" : ""}`;
  if (happening.isBack) return `${name} taken back`;
  return `${name} ended by ${happening.outcome?.name ?? "nothing"}`;
}

function eventInWords(event: Event, nameOf: NameOf): string {
  switch (event.type) {
    case "log":
      return event.path === "" ? event.message : `${nameOf(event.path)}: ${event.message}`;
    case "hit":
      return `Breakpoint at ${nameOf(event.path)} ${event.held ? "held" : "passed"}`;
    case "held":
      return `${nameOf(event.path)} held${event.next ? ` before ${nameOf(event.next)}` : ""}`;
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
      return `Taken up after a crash: ${event.crash.reason}`;
    case "went_back":
      return "The run began again at an earlier moment";
    case "forced":
      return `${nameOf(event.path)} was made to end by ${event.outcome.name}`;
    case "deadline_passed":
      return `${nameOf(event.path)} passed its deadline`;
    case "finished":
      return `The run ended by ${event.outcome.name}`;
    case "paused":
      return event.paused ? "Paused" : "Goes on";
    case "stopping":
      return "Stopping";
    case "root":
      return event.change === "" ? "The machine was read" : `The machine changed: ${event.change}`;
    case "waiting":
      return `${nameOf(event.path)} waits: ${event.reason}`;
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
