/** What was asked of the server and is not answered: said in the order in which it was asked for, and again after each break.
 * What is too large for a frame goes by a request, alone, when everything before it is answered. */

import type { Refusal, ToServer } from "../model/generated/protocol.ts";
import { RefusalError } from "../store/server.ts";

/** By which way something goes. */
export interface Ways {
  /** Over the socket; nothing happens while that is down. */
  readonly say: (frame: ToServer) => void;
  /** By a request. Fails with a [`RefusalError`], whose status is 0 if there was no answer. */
  readonly post: (frame: ToServer) => Promise<number>;
  /** Calls soon. */
  readonly soon: (call: () => void) => void;
}

interface Asked {
  readonly frame: ToServer;
  readonly isLarge: boolean;
  readonly answered: (revision: number) => void;
  readonly failed: (error: RefusalError) => void;
  isSaid: boolean;
}

/** No answer, no login, not at the moment: it is sent again. */
const LATER = new Set([0, 401, 503]);
/** A frame may have 1 MiB; this many characters are never more. */
const FRAME_LENGTH_MAX = 300_000;

export class Outgoing {
  readonly #ways: Ways;
  readonly #asked = new Map<string, Asked>();
  #isUp = false;

  constructor(ways: Ways) {
    this.#ways = ways;
  }

  /** Gives the revision that was made; fails with a [`RefusalError`]. */
  ask(id: string, frame: ToServer): Promise<number> {
    const isLarge = JSON.stringify(frame).length > FRAME_LENGTH_MAX;
    return new Promise((answered, failed) => {
      this.#asked.set(id, { frame, isLarge, answered, failed, isSaid: false });
      this.#pump();
    });
  }

  /** The connection is there: everything is said again. */
  up(): void {
    this.#isUp = true;
    for (const asked of this.#asked.values()) if (!asked.isLarge) asked.isSaid = false;
    this.#pump();
  }

  down(): void {
    this.#isUp = false;
  }

  answered(id: string, revision: number): void {
    this.#take(id)?.answered(revision);
    this.#pump();
  }

  refused(id: string, refusal: Refusal, status: number): void {
    this.#take(id)?.failed(new RefusalError(refusal, status));
    this.#pump();
  }

  #take(id: string): Asked | undefined {
    const asked = this.#asked.get(id);
    this.#asked.delete(id);
    return asked;
  }

  #pump(): void {
    if (!this.#isUp) return;
    let isFirst = true;
    for (const [id, asked] of this.#asked) {
      if (asked.isLarge && isFirst && !asked.isSaid) void this.#post(id, asked);
      if (asked.isLarge) return;
      if (!asked.isSaid) this.#ways.say(asked.frame);
      asked.isSaid = true;
      isFirst = false;
    }
  }

  async #post(id: string, asked: Asked): Promise<void> {
    asked.isSaid = true;
    try {
      this.answered(id, await this.#ways.post(asked.frame));
    } catch (error) {
      if (error instanceof RefusalError && !LATER.has(error.status)) {
        this.refused(id, { code: error.code, message: error.message }, error.status);
      } else {
        asked.isSaid = false;
        this.#ways.soon(() => this.#pump());
      }
    }
  }
}
