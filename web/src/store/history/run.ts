/** A run that the page watches: its latest status, its events, the shown moment, and the commands sent to it. All tabs that show
 * the run share it. */

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

/** A command that this page sent. Its effect is shown only after the answer. */
export interface SentCommand {
  readonly id: string;
  readonly command: Command;
  /** Times of sending and of expiry: ms since 1970 by this browser's clock. */
  readonly sent_ms: number;
  readonly expiry_ms: number;
  /** Result; null while it is unknown. `lost`: the result cannot be requested any more. */
  readonly answer:
    | Exclude<Answer, { answer: "unknown" }>
    | { readonly answer: "lost"; readonly reason: string }
    | null;
  /** Time when the result arrived; null while it is unknown. */
  readonly answered_ms: number | null;
}

/** State of the run after an event, with values; for an active run also the latest one requested. */
export interface RunSnapshot {
  readonly picture: Moment;
  /** Time of arrival: ms since 1970 by this browser's clock. */
  readonly at_ms: number;
}

export interface Watch {
  /** Id of the run. */
  readonly id: string;
  /** Latest status; null before the first. */
  readonly now: ReadonlySignal<RunNow | null>;
  /** Server time until which `now` is known to be true, apart from later messages on the current connection. */
  readonly proven_ms: ReadonlySignal<number | null>;
  /** True if `now` arrived over the current connection; false for a moment after a reconnect. */
  readonly isCurrent: ReadonlySignal<boolean>;
  /** Recent events: for a short run all received ones. Its size is limited; a long run continues in a new object. */
  readonly journal: Journal;
  /** Events around the shown moment: `journal`, or an earlier part that was requested. While that part loads, the previous one. */
  readonly window: Journal;
  /** Changes when one of the journals has grown or was replaced, at most ten times a second. */
  readonly journalVersion: ReadonlySignal<number>;
  /** True once all events from before the page connected, or reconnected, have arrived. */
  readonly isCaughtUp: ReadonlySignal<boolean>;
  /** Reason why the history is unavailable; null if it is available. */
  readonly lack: ReadonlySignal<string | null>;
  /** Playhead: the event whose moment is shown; null for live. */
  readonly playhead: Signal<number | null>;
  /** The shown moment with its values. Null while it loads; the previous moment stays for an instant. While live, it is at most a
   * second old if values are requested, and otherwise null. */
  readonly playheadSnapshot: ReadonlySignal<RunSnapshot | null>;
  /** Requests values while live. Returns a function that ends the request. */
  readonly wantValues: () => () => void;
  /** Values of a robot's run that arrived ahead of their events. The requester stores them here. */
  readonly ahead: Signal<AheadValues>;
  /** Commands of this page, the oldest first: pending ones and the last answered ones. */
  readonly sent: ReadonlySignal<readonly SentCommand[]>;
  /** Sends a command and retries until it is answered. It expires after `patience_ms`. Never throws. */
  readonly command: (command: Command, patience_ms?: number) => Promise<SentCommand>;
  /** Requests, releases or takes over control. Throws a `RefusalError`. */
  readonly control: (move: ControlMove) => Promise<Control>;
  /** Resumes a run whose runner died. Throws a `RefusalError`. */
  readonly resume: (policy: OnCrash, from?: number | null) => Promise<void>;
  /** Starts a new run with the inputs and settings of this one. Throws a `RefusalError`. */
  readonly startAgain: () => Promise<StartedRun>;
  readonly close: () => void;
  /** Calls the listener when the page leaves the run, to end what follows it. */
  readonly whenClosed: (call: () => void) => void;
}

/** Parameters of a start; the missing ones have defaults. */
export type Start = Pick<StartRun, "machine"> & Partial<Omit<StartRun, "id" | "machine">>;

/** All runs of the server. */
export interface Runs {
  /** The newest first. */
  readonly all: ReadonlySignal<readonly RunSummary[]>;
  /** Watches a run while it is shown. Of the others, the last requested ones stay watched. */
  readonly watch: (run: string) => Watch;
  /** Starts a run and returns its id. Throws a `RefusalError`. */
  readonly start: (start: Start) => Promise<string>;
  /** Has a robot of this station start a machine of its projects; returns the id of the run. Throws a `RefusalError`. */
  readonly startAtRobot: (robot: string, start: Start) => Promise<string>;
  /** Requests data below `/runs/{run}`: `events?…`, `statistics`, `compare/…`. Throws a `RefusalError`. */
  readonly get: <T>(run: string, what: string) => Promise<T>;
  /** Fetches a large value from its robot, or cancels that. Throws a `RefusalError`. */
  readonly fetchValue: <T>(run: string, value: number, isWanted: boolean) => Promise<T>;
  /** Deletes a run that is over. Throws a `RefusalError`. */
  readonly remove: (run: string) => Promise<void>;
  /** Reloads the list, because runs can also start without the server. */
  readonly refresh: () => Promise<void>;
}
