/** The network between a browser and a server: another address of this computer that leads to the server until it is cut. The port
 * is the server's own: by another one it would not feel meant. */

import { once } from "node:events";
import { connect, createServer, type Server as Listener, type Socket } from "node:net";
import type { Server } from "./server.ts";

/** How a network fails: nothing goes through any more and nobody says so, or whoever connects is sent away. */
export type Cut = "silent" | "refusing";

const ADDRESS = "127.0.0.2";

export class Wire {
  readonly #server: Server;
  readonly #listener: Listener;
  readonly #ends = new Set<Socket>();
  #cut: Cut | null = null;

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

  cut(how: Cut): void {
    this.#cut = how;
    for (const end of this.#ends) {
      if (how === "silent") end.pause();
      else end.destroy();
    }
  }

  /** What was connected is gone; from now on one connects again. */
  mend(): void {
    this.#cut = null;
    for (const end of this.#ends) end.destroy();
  }

  close(): void {
    this.mend();
    this.#listener.close();
  }

  #join(browser: Socket): void {
    if (this.#cut === "refusing") {
      browser.destroy();
      return;
    }
    const server = connect(this.#port, "127.0.0.1");
    for (const [one, other] of [
      [browser, server],
      [server, browser],
    ] as const) {
      this.#ends.add(one);
      one.on("data", (data) => {
        if (!this.#cut) other.write(data);
      });
      one.on("error", () => other.destroy());
      one.on("close", () => {
        this.#ends.delete(one);
        other.destroy();
      });
    }
    if (this.#cut === "silent") {
      browser.pause();
      server.pause();
    }
  }
}
