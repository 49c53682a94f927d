/** A run as the page watches it: its latest truth, all that happened, the moment that is looked at, and what it was told. Belongs
 * to every tab that shows it. */

import type { ReadonlySignal, Signal } from "@preact/signals-core";
import type {
  Answer,
  Command,
  Control,
  ControlMove,
  Moment,
  OnCrash,
  RunNow,
  RunSummary,
  StartedRun,
  StartRun,
} from "../../model/generated/protocol.ts";
import type { AheadValues } from "./ahead.ts";
import type { Journal } from "./journal.ts";

/** A command that this page sent. Nothing is drawn as done before it was answered. */
export interface SentCommand {
  readonly id: string;
  readonly command: Command;
  /** When it was given, and when it is no longer wanted: ms since 1970 by this browser's clock. */
  readonly sent_ms: number;
  readonly expiry_ms: number;
  /** What became of it; null while nobody knows. `lost` says that it cannot be asked for any more. */
  readonly answer:
    | Exclude<Answer, { answer: "unknown" }>
    | { readonly answer: "lost"; readonly reason: string }
    | null;
  /** When that was known; null while nobody knows. */
  readonly answered_ms: number | null;
}

/** How the run stood after an event, with values; of a run that goes on also the newest one that was asked for. */
export interface RunSnapshot {
  readonly picture: Moment;
  /** When it came: ms since 1970 by this browser's clock. */
  readonly at_ms: number;
}

export interface Watch {
  /** The run's id. */
  readonly id: string;
  /** The latest truth; null before it came. */
  readonly now: ReadonlySignal<RunNow | null>;
  /** The server's time at which `now` was true for sure, as far as that is known from before the connection that there is now. */
  readonly proven_ms: ReadonlySignal<number | null>;
  /** Whether it came over the connection that there is now: not yet in the first moments after a break. */
  readonly isCurrent: ReadonlySignal<boolean>;
  /** What happened lately, as far as it was told: of a run that is not long, all that happened. Bounded: a longer one goes on as another
   * object. */
  readonly journal: Journal;
  /** What happened around the moment that is shown: `journal`, or an earlier part that was asked for. While that is on its way, what
   * was there before. */
  readonly window: Journal;
  /** Another number whenever one of them has grown or is another one: ten times a second at most. */
  readonly journalVersion: ReadonlySignal<number>;
  /** Whether all that there was when the page came, or came back after a break, has been told. */
  readonly isCaughtUp: ReadonlySignal<boolean>;
  /** Why the history cannot be told, while it cannot. */
  readonly lack: ReadonlySignal<string | null>;
  /** The playhead: the event whose moment the page shows; null: live, at the end. */
  readonly playhead: Signal<number | null>;
  /** The moment with its values; null while it is on its way, but for a wink the moment before. While live it is a second old at
   * most, if anybody wants it, and null if nobody does. */
  readonly playheadSnapshot: ReadonlySignal<RunSnapshot | null>;
  /** Says that values are wanted while live; returns the way to stop. */
  readonly wantValues: () => () => void;
  /** Values of a robot's run that came ahead of their events: whoever asks for them keeps them here. */
  readonly ahead: Signal<AheadValues>;
  /** Commands of this page: those under way and the last ones that were answered, the oldest first. */
  readonly sent: ReadonlySignal<readonly SentCommand[]>;
  /** Sends a command. It is sent again until it is answered; not carried out after `patience_ms`. Never throws. */
  readonly command: (command: Command, patience_ms?: number) => Promise<SentCommand>;
  /** Asks for control, gives it away, takes it over. Throws a `RefusalError`. */
  readonly control: (move: ControlMove) => Promise<Control>;
  /** Resumes a run whose runner died. Throws a `RefusalError`. */
  readonly resume: (policy: OnCrash, from?: number | null) => Promise<void>;
  /** Starts a new run with the inputs and settings of this one. Throws a `RefusalError`. */
  readonly startAgain: () => Promise<StartedRun>;
  readonly close: () => void;
  /** Calls when the page leaves the run: what follows it ends with it. */
  readonly whenClosed: (call: () => void) => void;
}

/** What a start needs to be told; the rest has its default. */
export type Start = Pick<StartRun, "machine"> & Partial<Omit<StartRun, "id" | "machine">>;

/** All runs of the server. */
export interface Runs {
  /** The newest first. */
  readonly all: ReadonlySignal<readonly RunSummary[]>;
  /** The run, watched for as long as it is shown; of the others those that were asked for last. */
  readonly watch: (run: string) => Watch;
  /** Starts a run and gives its id. Throws a `RefusalError`. */
  readonly start: (start: Start) => Promise<string>;
  /** Asks below `/runs/{run}`: `events?…`, `statistics`, `compare/…`. Throws a `RefusalError`. */
  readonly get: <T>(run: string, what: string) => Promise<T>;
  /** Fetches a large value from its robot, or gives that up. Throws a `RefusalError`. */
  readonly fetchValue: <T>(run: string, value: number, isWanted: boolean) => Promise<T>;
  /** Gives up a run that is over. Throws a `RefusalError`. */
  readonly remove: (run: string) => Promise<void>;
  /** Asks for the list again: what was started without the server may be new. */
  readonly refresh: () => Promise<void>;
}
