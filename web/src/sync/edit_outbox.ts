/** The edits of this page that the confirmed machine does not have yet. Each is sent over the socket, or by a request if it is too large
 * for a frame, and is settled when its changes arrive. Knows frames, not the content of edits. */

import type { Done, Edit, ToServer } from "../model/generated/protocol.ts";
import type { EditAnswer, PendingEdit } from "../store/document/machine_session.ts";
import { RefusalError, type Server } from "../store/page/server.ts";
import type { Clock } from "./clock.ts";
import { AGAIN, HELD, Outbox } from "./outbox.ts";

/** Metadata of an edit, an undo or a redo. */
type EditFrame = Extract<ToServer, { frame: "edit" | "undo" | "redo" }>;

/** An edit, an undo (without one) or a redo on its way. */
export interface EditOnItsWay extends PendingEdit {
  readonly edit: Edit | null;
  /** As it is sent to the open machine with this id. */
  readonly frame: (machine: string) => EditFrame;
}

export interface EditOutboxPorts {
  readonly server: Server;
  readonly clock: Clock;
  /** The server's id of the open machine. */
  readonly machine: () => string;
  /** One made this revision. */
  readonly onAnswer: (revision: number) => void;
  readonly onRefusal: (edit: EditOnItsWay, error: RefusalError) => void;
}

interface SentEdit extends EditOnItsWay {
  readonly isLarge: boolean;
  /** The revision that it made, if that is known and not here yet. */
  made: number | null;
}

/** No answer, no login, not at the moment: it is sent again. */
const LATER = new Set([0, 401, 503]);
/** A frame may have 1 MiB; this many characters are never more. */
const FRAME_LENGTH_MAX = 300_000;

export class EditOutbox {
  readonly #ports: EditOutboxPorts;
  readonly #outbox: Outbox<SentEdit, number, EditAnswer>;
  readonly #stops: readonly (() => void)[];
  #isClosed = false;

  constructor(ports: EditOutboxPorts) {
    this.#ports = ports;
    const { server, clock } = ports;
    this.#outbox = new Outbox<SentEdit, number, EditAnswer>({
      clock,
      isUp: () => server.link.peek().state === "up",
      isAlone: ({ isLarge }) => isLarge,
      send: (edit) => this.#send(edit),
      onAnswer: (edit, revision) => {
        edit.made = revision;
        ports.onAnswer(revision);
        return HELD;
      },
      onRefusal: (edit, error) => {
        if (LATER.has(error.status)) return AGAIN;
        ports.onRefusal(edit, error);
        return HELD;
      },
    });
    this.#stops = [
      server.onAnswer((frame) => {
        if (frame.frame === "edited") this.#outbox.answered(frame.id, frame.revision);
        else if (frame.id !== null)
          this.#outbox.refused(frame.id, new RefusalError(frame.refusal, 409));
        this.#stopIfOver();
      }),
      server.link.subscribe(({ state }) => {
        if (state === "up") this.#outbox.connected();
      }),
    ];
  }

  /** All that is not settled, the oldest first. */
  get edits(): readonly EditOnItsWay[] {
    return this.#outbox.items;
  }

  put(edit: EditOnItsWay): Promise<EditAnswer> {
    const isLarge = JSON.stringify(edit.edit).length > FRAME_LENGTH_MAX;
    return this.#outbox.put({ ...edit, isLarge, made: null });
  }

  /** It is sent again although it was refused. */
  again(id: string): void {
    this.#outbox.again(id);
  }

  refuse(id: string, reason: string): void {
    this.#outbox.settle(id, { refused: reason });
  }

  /** The machine is at this revision, which the edit with this id made. */
  arrived(revision: number, id: string | null): void {
    for (const edit of this.#outbox.items) {
      if (edit.id === id) this.#outbox.settle(edit.id, { revision });
      else if (edit.made !== null && edit.made <= revision)
        this.#outbox.settle(edit.id, { revision: edit.made });
    }
  }

  /** Sent edits still arrive; no further ones are accepted. */
  close(): void {
    this.#isClosed = true;
    this.#stopIfOver();
  }

  #stopIfOver(): void {
    if (this.#isClosed && this.#outbox.items.length === 0) for (const stop of this.#stops) stop();
  }

  #send({ frame, isLarge }: SentEdit): Promise<number> | null {
    const { server, machine } = this.#ports;
    const message = frame(machine());
    if (!isLarge || message.frame !== "edit") {
      server.say(message);
      return null;
    }
    const path = `/machines/${encodeURIComponent(message.machine)}/edits`;
    return server.request<Done>("POST", path, message.edit).then(({ revision }) => revision);
  }
}
