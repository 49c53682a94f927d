/** One computer of the scenario: a folder of its own for everything, and one server in it, which is begun, killed and begun again. */

import { type ChildProcess, spawn, spawnSync } from "node:child_process";
import { once } from "node:events";
import { closeSync, mkdirSync, openSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { binary } from "../../e2e/support/places.ts";
import { endBegunBy } from "../../e2e/support/server.ts";

const running = new Set<ChildProcess>();
process.once("exit", () => {
  for (const child of running) child.kill("SIGKILL");
});
for (const signal of ["SIGINT", "SIGTERM"] as const) process.once(signal, () => process.exit(1));

/** Ends with this program. */
export function owned(child: ChildProcess): ChildProcess {
  running.add(child);
  child.once("exit", () => running.delete(child));
  return child;
}

/** Where its programs run. */
export interface Where {
  /** The program and its words that begin programs there. */
  readonly inside: readonly string[];
  readonly address: string;
}

const HERE: Where = { inside: [], address: "127.0.0.1" };

export class Host {
  readonly name: string;
  readonly folder: string;
  readonly #words: readonly string[];
  readonly #where: Where;
  #process: ChildProcess | null = null;
  #link = "";

  /** The words begin its server, all but its address. */
  constructor(name: string, folder: string, words: readonly string[], where: Where = HERE) {
    [this.name, this.folder, this.#words, this.#where] = [name, folder, words, where];
    mkdirSync(folder, { recursive: true });
  }

  /** The address that lets the owner in. */
  get link(): string {
    return this.#link;
  }

  get url(): string {
    return new URL(this.#link).origin;
  }

  get runs(): string {
    return join(this.folder, "runs");
  }

  get pid(): number {
    return this.#process?.pid ?? 0;
  }

  /** The program and its words that begin programs on this computer. */
  get inside(): readonly string[] {
    return this.#where.inside;
  }

  get env(): NodeJS.ProcessEnv {
    const state = join(this.folder, "state");
    return { ...process.env, HOME: this.folder, RAFCON_STATE: state, RAFCON_RUNS: this.runs };
  }

  /** Begins the server, at its earlier port if it had one. */
  async begin(): Promise<void> {
    const port = this.#link === "" ? "0" : new URL(this.#link).port;
    const log = openSync(join(this.folder, "stderr.log"), "a");
    const { inside, address } = this.#where;
    const bind = ["--bind", `${address}:${port}`, "--keep-token"];
    const [program = "", ...words] = [...inside, binary(), ...this.#words, ...bind];
    const stdio = ["ignore", "pipe", log] as ["ignore", "pipe", number];
    const child = owned(spawn(program, words, { env: this.env, stdio }));
    closeSync(log);
    this.#process = child;
    if (!child.stdout) throw new Error(`${this.name} has no standard output`);
    const lines = createInterface({ input: child.stdout });
    const gone = once(child, "exit").then(([code]) => {
      throw new Error(`${this.name} ended at once (${code}): see ${this.folder}/stderr.log`);
    });
    const [link] = await Promise.race([once(lines, "line"), gone]);
    gone.catch(() => undefined);
    this.#link = String(link);
  }

  /** It is gone at once, as after a power cut of this program alone. */
  async kill(): Promise<void> {
    const child = this.#process;
    this.#process = null;
    if (!child || child.exitCode !== null) return;
    const gone = once(child, "exit");
    child.kill("SIGKILL");
    await gone;
  }

  /** Ends the server and what it has begun. */
  async end(): Promise<void> {
    await this.kill();
    endBegunBy(join(this.folder, "state"));
  }

  /** What a command says on this computer. */
  say(words: readonly string[], input = ""): string {
    const options = { env: this.env, input, maxBuffer: 1 << 30 };
    const { status, stdout, stderr } = spawnSync(binary(), words, options);
    if (status !== 0) throw new Error(`rafcon ${words.join(" ")}: ${stderr}`);
    return String(stdout);
  }

  /** A user, and a token for a program of theirs. */
  user(name: string): string {
    this.say(["user", "add", name, "--role", "admin"], `a password of ${name}\n`);
    return (
      this.say(["user", "token", "--for", "the scenario", name]).trim().split("\n").at(-1) ?? ""
    );
  }

  /** Asks the interface below `/api/v1` as the owner, or with another token. */
  async ask<T>(method: string, path: string, body?: unknown, token = this.#token): Promise<T> {
    const headers = { authorization: `Bearer ${token}`, "content-type": "application/json" };
    const wanted = { method, headers, ...(body ? { body: JSON.stringify(body) } : {}) };
    const answer = await fetch(`${this.url}/api/v1${path}`, wanted);
    const text = await answer.text();
    if (!answer.ok) throw new Error(`${method} ${path}: ${answer.status} ${text}`);
    return JSON.parse(text) as T;
  }

  get #token(): string {
    return new URL(this.#link).searchParams.get("token") ?? "";
  }

  /** The memory of its server, in MB. */
  memory(): number {
    try {
      const status = readFileSync(`/proc/${this.pid}/status`, "utf8");
      return Number(/VmRSS:\s+(\d+)/.exec(status)?.[1] ?? 0) / 1_024;
    } catch {
      return 0;
    }
  }
}
