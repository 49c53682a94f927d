/** The server as the rest of the page knows it: a port, filled by `sync` and in tests by a few lines. */

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

/** How the connection is. */
export type Link =
  | { readonly state: "connecting" }
  | { readonly state: "up"; readonly session: Session; readonly connection: number }
  /** `retry_ms`: when it is tried again, in ms since 1970; nobody retries what needs a login. */
  | {
      readonly state: "down";
      readonly since_ms: number;
      readonly retry_ms: number | null;
      readonly reason: string;
    }
  | { readonly state: "refused"; readonly reason: string };

/** How the server is heard. */
export interface ServerPulse {
  /** When it was heard last: ms since 1970 by this browser's clock. */
  readonly heard_ms: number;
  /** How long a question and its answer took last. */
  readonly delay_ms: number | null;
  /** So much is the server's clock ahead of this browser's. */
  readonly ahead_ms: number;
  /** The server's time when it said what was heard last: ms since 1970 by its own clock. */
  readonly server_ms: number;
  /** What was not confirmed for so long counts as old: it follows from the delay. */
  readonly old_ms: number;
}

/** Of a request that is repeated until it is answered: it is given up sooner. */
export const REPEATED = "repeated";

/** What the server refused, or why it could not be asked. */
export class RefusalError extends Error {
  readonly code: string;
  /** The HTTP status; 0 if there was no answer. */
  readonly status: number;

  constructor(refusal: Refusal, status: number) {
    super(inPageWords(refusal.message));
    this.name = "RefusalError";
    this.code = refusal.code;
    this.status = status;
  }

  /** Whether the same may be answered otherwise later: the server did not answer, is busy, or cannot do it now. */
  get isForNow(): boolean {
    return this.status === 0 || this.status === 429 || this.status >= 500;
  }
}

/** What becomes of a subscription. Frames come in order; after a break `topic` is asked where to go on. The last frame is
 * `ended` or `reset`: whoever wants more follows anew. */
export interface Follower {
  readonly topic: () => Topic;
  readonly frame: (frame: ToClient) => void;
}

/** What became of an edit, an undo or a redo. */
export type AnswerFrame = Extract<ToClient, { frame: "edited" | "refused" }>;

export interface Server {
  readonly link: ReadonlySignal<Link>;
  /** Null before the server was heard for the first time. */
  readonly pulse: ReadonlySignal<ServerPulse | null>;
  /** Asks below `/api/v1`; throws a [`RefusalError`], also if nothing comes for too long. */
  readonly request: <T>(
    method: "GET" | "POST" | "PUT" | "PATCH" | "DELETE",
    path: string,
    body?: unknown,
    patience?: typeof REPEATED,
  ) => Promise<T>;
  /** Asks for what comes line by line as JSON, for as long as the server needs, and tells each line; `signal` ends it. Throws as
   * `request` does. */
  readonly lines: <T>(
    path: string,
    body: unknown,
    tell: (line: T) => void,
    signal: AbortSignal,
  ) => Promise<void>;
  /** Follows a topic until the returned function is called, over every break of the connection. */
  readonly follow: (follower: Follower) => () => void;
  /** Tells the answers to frames that were said with an id, until the returned function is called. */
  readonly onAnswer: (listener: (frame: AnswerFrame) => void) => () => void;
  /** Sends a frame if the connection is up; nothing otherwise. */
  readonly say: (frame: ToServer) => void;
  /** Connects again at once: after a login, or because the user does not want to wait. */
  readonly retry: () => void;
}

export type { Refusal, Revision, Session };
