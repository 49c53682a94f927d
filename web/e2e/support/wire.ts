/** The network between a browser and a server: another address of this computer that leads to the server, at once or slowly, until
 * it is cut. A cut that nobody is told of holds what is on its way, as TCP does: afterwards all of it arrives. The port is the
 * server's own: by another one it would not feel meant. */

import { once } from "node:events";
import { connect, createServer, type Server as Listener, type Socket } from "node:net";
import type { Server } from "./server.ts";

/** How a network fails: nothing goes through any more and nobody says so, or whoever connects is sent away. */
export type Cut = "silent" | "refusing";

/** How slow a network is. */
export interface Pace {
  /** So long each byte takes. */
  readonly oneWay_ms: number;
  /** So many bytes go each way in a second, those of all connections together. */
  readonly bytesPerSecond: number;
  /** Rounds before the first byte of a connection: one for TCP, one more for TLS. */
  readonly handshakes: number;
}

const AT_ONCE: Pace = { oneWay_ms: 0, bytesPerSecond: Number.POSITIVE_INFINITY, handshakes: 0 };
const ADDRESS = "127.0.0.2";
/** So many bytes of a connection are on their way at once at least, and where nothing limits a connection but its window: as with TCP. */
const WINDOW = { least: 64 << 10, most: 4 << 20 };

export class Wire {
  readonly #server: Server;
  readonly #listener: Listener;
  readonly #pipes = new Set<Pipe>();
  readonly #free_ms = { up: 0, down: 0 };
  #pace = AT_ONCE;
  #cut: Cut | null = null;
  /** How often somebody connected. */
  connections = 0;

  private constructor(server: Server) {
    this.#server = server;
    this.#listener = createServer((browser) => this.#join(browser));
  }

  static async to(server: Server): Promise<Wire> {
    const wire = new Wire(server);
    wire.#listener.listen(wire.#port, ADDRESS);
    await once(wire.#listener, "listening");
    return wire;
  }

  /** The address that lets the owner in, over this wire. */
  get link(): string {
    const link = new URL(this.#server.link);
    link.hostname = ADDRESS;
    return link.toString();
  }

  get #port(): number {
    return Number(new URL(this.#server.link).port);
  }

  get isCut(): boolean {
    return this.#cut === "silent";
  }

  /** From now on the network is so slow. */
  slow(pace: Partial<Pace>): void {
    this.#pace = { ...AT_ONCE, ...pace };
  }

  /** Whoever is connected loses the connection, and may connect again. */
  reset(): void {
    for (const pipe of this.#pipes) pipe.destroy();
  }

  cut(how: Cut): void {
    this.#cut = how;
    if (how === "refusing") this.reset();
  }

  /** The network is there again: what was held back goes on. */
  mend(): void {
    this.#cut = null;
    for (const pipe of this.#pipes) pipe.pump();
  }

  close(): void {
    this.reset();
    this.#listener.close();
  }

  /** When a piece that is sent now arrives at the other side. */
  arrival(direction: "up" | "down", bytes: number, begun_ms: number): number {
    const { oneWay_ms, bytesPerSecond, handshakes } = this.#pace;
    const from_ms = Math.max(Date.now(), begun_ms + handshakes * 2 * oneWay_ms);
    const sent_ms = Math.max(from_ms, this.#free_ms[direction]) + (bytes / bytesPerSecond) * 1_000;
    if (bytesPerSecond !== Number.POSITIVE_INFINITY) this.#free_ms[direction] = sent_ms;
    return sent_ms + oneWay_ms;
  }

  /** So many bytes of a connection are on their way at once: twice what fits into a round trip. */
  get window(): number {
    const { oneWay_ms, bytesPerSecond } = this.#pace;
    if (bytesPerSecond === Number.POSITIVE_INFINITY) return WINDOW.most;
    const wanted = 2 * bytesPerSecond * ((2 * oneWay_ms) / 1_000);
    return Math.min(WINDOW.most, Math.max(WINDOW.least, wanted));
  }

  #join(browser: Socket): void {
    if (this.#cut === "refusing") {
      browser.destroy();
      return;
    }
    this.connections += 1;
    const server = connect(this.#port, "127.0.0.1");
    for (const pipe of [
      new Pipe(this, "up", browser, server),
      new Pipe(this, "down", server, browser),
    ]) {
      this.#pipes.add(pipe);
      pipe.over = () => this.#pipes.delete(pipe);
    }
  }
}

/** One direction of one connection. */
class Pipe {
  readonly #wire: Wire;
  readonly #from: Socket;
  readonly #to: Socket;
  /** Nothing: the sender is gone. */
  readonly #queue: { readonly at_ms: number; readonly data: Buffer | null }[] = [];
  #timer: ReturnType<typeof setTimeout> | undefined;
  over: () => void = () => {};

  constructor(wire: Wire, direction: "up" | "down", from: Socket, to: Socket) {
    [this.#wire, this.#from, this.#to] = [wire, from, to];
    const begun_ms = Date.now();
    let last_ms = 0;
    const put = (data: Buffer | null) => {
      last_ms = Math.max(last_ms, wire.arrival(direction, data?.length ?? 0, begun_ms));
      this.#queue.push({ at_ms: last_ms, data });
      if (this.#waiting > wire.window) from.pause();
      this.pump();
    };
    from.on("data", put);
    from.on("error", () => {});
    from.on("close", () => put(null));
  }

  /** Delivers what is due. */
  pump(): void {
    clearTimeout(this.#timer);
    if (this.#wire.isCut) return;
    for (let next = this.#queue[0]; next; next = this.#queue[0]) {
      const wait_ms = next.at_ms - Date.now();
      if (wait_ms > 0) {
        this.#timer = setTimeout(() => this.pump(), wait_ms);
        break;
      }
      this.#queue.shift();
      if (next.data === null) this.destroy();
      else this.#to.write(next.data);
    }
    if (this.#from.isPaused() && this.#waiting <= this.#wire.window) this.#from.resume();
  }

  destroy(): void {
    clearTimeout(this.#timer);
    this.#from.destroy();
    this.#to.destroy();
    this.over();
  }

  get #waiting(): number {
    return this.#queue.reduce((sum, { data }) => sum + (data?.length ?? 0), 0);
  }
}
