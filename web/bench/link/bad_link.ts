/** The bad network between a robot and a station: the repository's own program, told by lines what to be. */

import { type ChildProcess, spawn } from "node:child_process";
import { on, once } from "node:events";
import { existsSync } from "node:fs";
import { join } from "node:path";
import { createInterface, type Interface } from "node:readline";
import { REPOSITORY } from "../../e2e/support/places.ts";
import { owned } from "./host.ts";

/** One direction. */
export interface Way {
  readonly bytes: number;
  readonly cut: "cut" | "hold" | null;
}

export interface PathNow {
  readonly now_ms: number;
  readonly down: Way;
  readonly up: Way;
  readonly error?: string;
}

export class BadLink {
  readonly #process: ChildProcess;
  readonly #answers: ((line: string) => void)[] = [];
  /** Where robots send. */
  readonly address: string;

  /** A network of two hosts with real kernels; the names of their namespaces begin with `name`. */
  static async ofHosts(name: string, words: readonly string[]): Promise<BadLink> {
    return BadLink.#begin(["--tun", name, ...words], /^the station is \S+/);
  }

  private constructor(child: ChildProcess, lines: Interface, address: string) {
    [this.#process, this.address] = [child, address];
    lines.on("line", (line) => this.#answers.shift()?.(line));
  }

  /** One that leads to a station's address. */
  static async to(station: string, words: readonly string[] = []): Promise<BadLink> {
    const listen = ["--listen", "127.0.0.1:0", "--to", station];
    return BadLink.#begin([...listen, ...words], /udp:\/\/\S+/);
  }

  /** Begins one, and waits until it says where it is. */
  static async #begin(words: readonly string[], where: RegExp): Promise<BadLink> {
    const program =
      process.env["RAFCON_LINK_PROXY"] ?? join(REPOSITORY, "target/debug/examples/link_proxy");
    if (!existsSync(program)) throw new Error(`there is no ${program}: run it by \`cargo xtask\``);
    const child = owned(spawn(program, words, { stdio: ["pipe", "pipe", "inherit"] }));
    if (!child.stdout) throw new Error("the bad link has no standard output");
    const lines = createInterface({ input: child.stdout });
    for await (const line of on(lines, "line", { close: ["close"] })) {
      const address = where.exec(String(line))?.[0];
      if (address) return new BadLink(child, lines, address);
    }
    throw new Error("the bad link ended at once");
  }

  /** Ends it, and what it has made. */
  async end(): Promise<void> {
    const gone = once(this.#process, "exit");
    this.#process.stdin?.write("end\n");
    await gone;
  }

  /** Says a line; how the path is then. */
  async say(line: string): Promise<PathNow> {
    const answer = new Promise<string>((done) => this.#answers.push(done));
    this.#process.stdin?.write(`${line}\n`);
    const now = JSON.parse(await answer) as PathNow;
    if (now.error) throw new Error(now.error);
    return now;
  }
}
