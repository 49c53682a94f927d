/** Interface of the server for the rest of the page, implemented by `sync`, and in tests by a few lines. */

import type { ReadonlySignal } from "@preact/signals-core";
import type {
  Refusal,
  Revision,
  Session,
  ToClient,
  Topic,
  ToServer,
} from "../../model/generated/protocol.ts";
import { inPageWords } from "../../model/page_words.ts";

/** State of the connection. */
export type Link =
  | { readonly state: "connecting" }
  | { readonly state: "up"; readonly session: Session; readonly connection: number }
  /** `retry_ms`: time of the next attempt, in ms since 1970; null if a login is needed first. */
  | {
      readonly state: "down";
      readonly since_ms: number;
      readonly retry_ms: number | null;
      readonly reason: string;
    }
  | { readonly state: "refused"; readonly reason: string };

/** Timing of the connection to the server. */
export interface ServerPulse {
  /** Time of the last received message: ms since 1970 by this browser's clock. */
  readonly heard_ms: number;
  /** Latest round-trip time; null before the first measurement. */
  readonly delay_ms: number | null;
  /** Offset of the server's clock: positive if ahead of this browser's. */
  readonly ahead_ms: number;
  /** Server time of the last received message: ms since 1970 by its own clock. */
  readonly server_ms: number;
  /** Age from which unconfirmed data counts as old. Derived from the delay. */
  readonly old_ms: number;
}

/** Marks a request that is repeated until answered: each attempt has a shorter timeout. */
export const REPEATED = "repeated";

/** Refusal by the server, or the reason why it could not be reached. */
export class RefusalError extends Error {
  readonly code: string;
  /** HTTP status; 0 without a response. */
  readonly status: number;

  constructor(refusal: Refusal, status: number) {
    super(inPageWords(refusal.message));
    this.name = "RefusalError";
    this.code = refusal.code;
    this.status = status;
  }

  /** True if a retry may succeed: the server did not respond, is busy, or has a temporary problem. */
  get isForNow(): boolean {
    return this.status === 0 || this.status === 429 || this.status >= 500;
  }
}

/** Receiver of a subscription. Frames arrive in order. After a reconnect, `topic` returns the position to continue from. `ended` or
 * `reset` is the last frame; to receive more, subscribe again. */
export interface Follower {
  readonly topic: () => Topic;
  readonly frame: (frame: ToClient) => void;
}

/** Result of an edit, an undo or a redo. */
export type AnswerFrame = Extract<ToClient, { frame: "edited" | "refused" }>;

export interface Server {
  readonly link: ReadonlySignal<Link>;
  /** Null before the first message from the server. */
  readonly pulse: ReadonlySignal<ServerPulse | null>;
  /** Sends a request below `/api/v1`. Throws a [`RefusalError`], also after a timeout. */
  readonly request: <T>(
    method: "GET" | "POST" | "PUT" | "PATCH" | "DELETE",
    path: string,
    body?: unknown,
    patience?: typeof REPEATED,
  ) => Promise<T>;
  /** Requests a stream of JSON lines without a time limit. The callback receives each line, and `signal` aborts the request. Throws
   * like `request`. */
  readonly lines: <T>(
    path: string,
    body: unknown,
    tell: (line: T) => void,
    signal: AbortSignal,
  ) => Promise<void>;
  /** Subscribes to a topic until the returned function is called, across reconnects. */
  readonly follow: (follower: Follower) => () => void;
  /** Reports the results of frames sent with an id, until the returned function is called. */
  readonly onAnswer: (listener: (frame: AnswerFrame) => void) => () => void;
  /** Sends a frame if the connection is up; otherwise drops it. */
  readonly say: (frame: ToServer) => void;
  /** Reconnects immediately: after a login, or on the user's request. */
  readonly retry: () => void;
}

export type { Refusal, Revision, Session };
