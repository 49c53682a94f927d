/** What was asked of the server and is not answered: said in the order in which it was asked for, and again after each break.
 * What is too large for a frame goes by a request, alone, when everything before it is answered. */

import type { Refusal, ToServer } from "../model/generated/protocol.ts";
import { RefusalError } from "../store/page/server.ts";

/** By which way something goes. */
interface Transport {
  /** Over the socket; nothing happens while that is down. */
  readonly send: (frame: ToServer) => void;
  /** By a request. Fails with a [`RefusalError`], whose status is 0 if there was no answer. */
  readonly post: (frame: ToServer) => Promise<number>;
  /** Calls soon. */
  readonly soon: (call: () => void) => void;
}

interface PendingRequest {
  readonly frame: ToServer;
  readonly isLarge: boolean;
  readonly answered: (revision: number) => void;
  readonly failed: (error: RefusalError) => void;
  isSent: boolean;
}

/** No answer, no login, not at the moment: it is sent again. */
const LATER = new Set([0, 401, 503]);
/** A frame may have 1 MiB; this many characters are never more. */
const FRAME_LENGTH_MAX = 300_000;

export class Outgoing {
  readonly #transport: Transport;
  readonly #pending = new Map<string, PendingRequest>();
  #isUp = false;

  constructor(transport: Transport) {
    this.#transport = transport;
  }

  /** Gives the revision that was made; fails with a [`RefusalError`]. */
  ask(id: string, frame: ToServer): Promise<number> {
    const isLarge = JSON.stringify(frame).length > FRAME_LENGTH_MAX;
    return new Promise((answered, failed) => {
      this.#pending.set(id, { frame, isLarge, answered, failed, isSent: false });
      this.#pump();
    });
  }

  /** The connection is there: everything is sent again. */
  up(): void {
    this.#isUp = true;
    for (const request of this.#pending.values()) if (!request.isLarge) request.isSent = false;
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

  #take(id: string): PendingRequest | undefined {
    const request = this.#pending.get(id);
    this.#pending.delete(id);
    return request;
  }

  #pump(): void {
    if (!this.#isUp) return;
    let isFirst = true;
    for (const [id, request] of this.#pending) {
      if (request.isLarge && isFirst && !request.isSent) void this.#post(id, request);
      if (request.isLarge) return;
      if (!request.isSent) this.#transport.send(request.frame);
      request.isSent = true;
      isFirst = false;
    }
  }

  async #post(id: string, request: PendingRequest): Promise<void> {
    request.isSent = true;
    try {
      this.answered(id, await this.#transport.post(request.frame));
    } catch (error) {
      if (error instanceof RefusalError && !LATER.has(error.status)) {
        this.refused(id, { code: error.code, message: error.message }, error.status);
      } else {
        request.isSent = false;
        this.#transport.soon(() => this.#pump());
      }
    }
  }
}
