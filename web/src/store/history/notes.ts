/** Marks for the time line of a run: warnings, errors, breakpoints, commands, questions, crashes. The journal is read as it grows;
 * events that it has dropped are missing. */

import type { Event } from "../../model/generated/protocol.ts";
import { perOwner } from "../../model/per_owner.ts";
import { lowerBound } from "./column.ts";
import { type Journal, OTHER } from "./journal.ts";

/** In ascending priority: where only one mark fits, the later kind covers the others. */
export const NOTE_KINDS = [
  "command",
  "edit",
  "question",
  "breakpoint",
  "back",
  "warning",
  "error",
  "crash",
] as const;

export type NoteKind = (typeof NOTE_KINDS)[number];

interface Note {
  /** Index in the journal. */
  readonly index: number;
  readonly kind: NoteKind;
}

export class Notes {
  readonly all: Note[] = [];
  readonly journal: Journal;
  #read = 0;

  constructor(journal: Journal) {
    this.journal = journal;
  }

  follow(): void {
    for (; this.#read < this.journal.length; this.#read++) {
      if (this.journal.kind(this.#read) !== OTHER) continue;
      const event = this.journal.other(this.#read);
      const kind = event && kindOf(event);
      if (kind) this.all.push({ index: this.#read, kind });
    }
  }

  /** Place of the first note at this event of the journal or later. */
  firstFrom(index: number): number {
    return lowerBound(this.all.length, (place) => (this.all[place]?.index ?? 0) < index);
  }
}

function kindOf(event: Event): NoteKind | null {
  switch (event.type) {
    case "log":
      return event.level === "warning" || event.level === "error" ? event.level : null;
    case "hit":
      return "breakpoint";
    case "commanded":
    case "forced":
      return "command";
    case "asked":
    case "closed":
      return "question";
    case "resumed":
    case "cut_off":
      return "crash";
    case "damaged":
      return "error";
    case "deadline_passed":
    case "loss_recovery":
      return "warning";
    case "went_back":
      return "back";
    case "root":
      return event.change === "" ? null : "edit";
    default:
      return null;
  }
}

const knownNotes = perOwner((journal: Journal) => new Notes(journal));

/** Notes of a journal up to its current end. */
export function notesOf(journal: Journal): Notes {
  const notes = knownNotes(journal);
  notes.follow();
  return notes;
}
