/** Follows one open machine at the server over everything that can happen to it: breaks of the connection, a restart of the
 * server, a closing by others. Knows how to have it again; never what the machine is. */

import type {
  MachineDocument,
  MachineFile,
  MachineStatus,
  MachineSummary,
  Revision,
  ToClient,
} from "../model/generated/protocol.ts";
import { RefusalError, type Server } from "../store/page/server.ts";
import type { Clock } from "./clock.ts";

/** The receiver of the changes. */
export interface Follows {
  /** Last received revision. */
  readonly revision: () => number;
  readonly revisions: (revisions: readonly Revision[]) => void;
  readonly status: (status: MachineStatus) => void;
  /** The whole machine, because the received revisions do not lead to it. */
  readonly whole: (document: MachineDocument) => void;
  /** It cannot be had any more. */
  readonly gone: (reason: string) => void;
}

/** Retry interval of a machine that cannot be loaded, in ms. */
const AGAIN_MS = 1_000;

export class MachineFollower {
  readonly #server: Server;
  readonly #clock: Clock;
  readonly #follows: Follows;
  #id: string;
  #file: MachineFile | null;
  #isOver = false;
  #unfollow: readonly (() => void)[] = [];
  #returning: Promise<boolean> | null = null;
  /** True if it has to be opened again. */
  #wasClosed = false;

  constructor(summary: MachineSummary, server: Server, clock: Clock, follows: Follows) {
    this.#server = server;
    this.#clock = clock;
    this.#follows = follows;
    this.#id = summary.id;
    this.#file = summary.file;
    this.#follow();
  }

  /** The server's id of the machine. */
  get id(): string {
    return this.#id;
  }

  get isOver(): boolean {
    return this.#isOver;
  }

  /** Path of its requests. */
  get path(): string {
    return `/machines/${encodeURIComponent(this.#id)}`;
  }

  end(): void {
    this.#isOver = true;
    this.#drop();
  }

  /** Opens it again; false if it cannot be had any more. */
  reopen(): Promise<boolean> {
    return this.#return(true);
  }

  #drop(): void {
    for (const stop of this.#unfollow) stop();
    this.#unfollow = [];
  }

  #follow(): void {
    const from = () => this.#follows.revision() + 1;
    const history = this.#server.follow({
      topic: () => ({ topic: "machine_history", machine: this.#id, from: from() }),
      frame: (frame) => this.#hear(frame),
    });
    const status = this.#server.follow({
      topic: () => ({ topic: "machine_status", machine: this.#id }),
      frame: (frame) => {
        if (frame.frame === "machine_status") this.#receiveStatus(frame.status);
      },
    });
    this.#unfollow = [history, status];
  }

  #hear(frame: ToClient): void {
    if (frame.frame === "revisions") this.#follows.revisions(frame.revisions);
    else if (frame.frame === "reset") void this.#return(false);
    else if (frame.frame === "ended") void this.#return(true);
  }

  #receiveStatus(status: MachineStatus): void {
    this.#file = status.summary.file;
    this.#follows.status(status);
  }

  #return(wasClosed: boolean): Promise<boolean> {
    if (wasClosed) this.#wasClosed = true;
    this.#returning ??= this.#comeBack().finally(() => {
      this.#returning = null;
      this.#wasClosed = false;
    });
    return this.#returning;
  }

  async #comeBack(): Promise<boolean> {
    while (!this.#isOver) {
      const opens = this.#wasClosed;
      try {
        const whole = await this.#fetch(opens);
        if (this.#isOver) return false;
        this.#drop();
        this.#follows.whole(whole);
        this.#follow();
        return true;
      } catch (error) {
        if (!(error instanceof RefusalError)) throw error;
        // The machine was closed during the request.
        if (this.#wasClosed && !opens) continue;
        // After a new login it continues.
        if (!error.isForNow && error.status !== 401) {
          this.#follows.gone(error.message);
          return false;
        }
        await new Promise<void>((again) => this.#clock.after(AGAIN_MS, again));
      }
    }
    return false;
  }

  async #fetch(opens: boolean): Promise<MachineDocument> {
    if (opens && this.#file) {
      const body = { file: this.#file };
      const open = await this.#server.request<MachineSummary>("POST", "/machines/open", body);
      this.#id = open.id;
    }
    return this.#server.request<MachineDocument>("GET", `${this.path}/document`);
  }
}
