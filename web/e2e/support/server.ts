/** The real server, as a process with folders of its own: begun, ended, killed, begun again at the same port. */

import { type ChildProcess, execFileSync, spawn } from "node:child_process";
import { once } from "node:events";
import { readdirSync, readFileSync, rmSync } from "node:fs";
import { delimiter, dirname, join } from "node:path";
import { createInterface } from "node:readline";
import type { Readable } from "node:stream";
import { binary, type Place } from "./places.ts";

/** What runs now. A journey that takes too long is given up with its worker, and its server ends with that. */
const running = new Set<ChildProcess>();
process.once("exit", () => {
  for (const child of running) child.kill("SIGKILL");
});

export class Server {
  readonly place: Place;
  readonly #command: "serve" | "station";
  readonly #more: readonly string[];
  #process: ChildProcess | null = null;
  #link = "";
  #radio = "";

  private constructor(place: Place, command: "serve" | "station", more: readonly string[]) {
    this.place = place;
    this.#command = command;
    this.#more = more;
  }

  /** Begins a server, with more words for its command line. */
  static async start(
    place: Place,
    command: "serve" | "station" = "serve",
    more: readonly string[] = [],
  ): Promise<Server> {
    const server = new Server(place, command, more);
    await server.#begin(0);
    return server;
  }

  /** Of a station: where robots are received. */
  get radio(): string {
    return this.#radio;
  }

  /** The address that lets the owner in. */
  get link(): string {
    return this.#link;
  }

  /** Scheme, name and port. */
  get url(): string {
    return new URL(this.#link).origin;
  }

  /** The number of its process; 0 while there is none. */
  get pid(): number {
    return this.#process?.pid ?? 0;
  }

  get token(): string {
    return new URL(this.#link).searchParams.get("token") ?? "";
  }

  get #state(): string {
    return join(this.place.folder, "state");
  }

  /** Asks the interface below `/api/v1` as the owner; the answer as JSON. */
  async ask<T>(method: string, path: string, body?: unknown): Promise<T> {
    const authorization = `Bearer ${this.token}`;
    // A connection for each request: the server closes idle ones, which a test that computes for long learns too late.
    const headers = { authorization, "content-type": "application/json", connection: "close" };
    const wanted = {
      method,
      headers,
      ...(body === undefined ? {} : { body: JSON.stringify(body) }),
    };
    const answer = await fetch(`${this.url}/api/v1${path}`, wanted);
    const text = await answer.text();
    if (!answer.ok) throw new Error(`${method} ${path}: ${answer.status} ${text}`);
    return (text === "" ? null : JSON.parse(text)) as T;
  }

  /** Ends it as an operator does, by a signal. */
  async end(signal: NodeJS.Signals = "SIGTERM"): Promise<void> {
    const process = this.#process;
    this.#process = null;
    if (!process || process.exitCode !== null) return;
    const gone = once(process, "exit");
    process.kill(signal);
    await gone;
  }

  /** Stops it in the middle of whatever it does: it hears nothing and answers nothing until it is thawed or ended. */
  freeze(): void {
    this.#process?.kill("SIGSTOP");
  }

  /** It goes on. */
  thaw(): void {
    this.#process?.kill("SIGCONT");
  }

  /** Begins again where it was, with the same folders and token. */
  async restart(): Promise<void> {
    await this.#begin(Number(new URL(this.#link).port));
  }

  /** Ends it with the runs that go on without it, as they do, and forgets its folders. */
  async dispose(): Promise<void> {
    await this.end("SIGKILL");
    endBegunBy(this.#state);
    rmSync(this.place.folder, { recursive: true, force: true });
  }

  async #begin(port: number): Promise<void> {
    const { folder, project, libraries } = this.place;
    const words = [
      this.#command,
      project,
      ...this.#more,
      "--bind",
      `127.0.0.1:${port}`,
      "--keep-token",
    ];
    words.push("--config", join(folder, "config.yaml"));
    for (const [name, root] of Object.entries(libraries)) {
      words.push("--library-path", `${name}=${root}`);
    }
    const { programs = [] } = this.place;
    const path = [process.env["PATH"], ...programs.map(dirname)].join(delimiter);
    const env = { ...process.env, PATH: path, ...foldersIn(this.place) };
    const isStation = this.#command === "station";
    const stdio = ["ignore", "pipe", isStation ? "pipe" : "inherit"] as const;
    const child = spawn(binary(), words, { env, stdio: [...stdio] });
    this.#process = child;
    running.add(child);
    child.once("exit", () => running.delete(child));
    const radio = isStation ? lineWith(child.stderr, "udp://") : "";
    this.#link = await firstLine(child);
    this.#radio = (await radio).replace(/.*(?=udp:)/, "");
  }
}

/** Has the program do something with the folders of a place; answers what it wrote. */
export function callIn(place: Place, words: readonly string[], input = ""): string {
  const env = { ...process.env, ...foldersIn(place) };
  return execFileSync(binary(), words, { env, input, encoding: "utf8", stdio: "pipe" });
}

function foldersIn({ folder }: Place) {
  return { RAFCON_STATE: join(folder, "state"), RAFCON_RUNS: join(folder, "runs") };
}

/** Ends what was begun by a server with this folder for its state, runs above all. */
export function endBegunBy(state: string): void {
  for (const pid of begunBy(state)) kill(pid);
}

/** The processes that were begun by a server with this folder for its state, and whatever they began. */
function begunBy(state: string): readonly number[] {
  const all = readdirSync("/proc").filter((pid) => /^\d+$/.test(pid));
  return all.filter((pid) => settingsOf(pid).includes(`RAFCON_STATE=${state}`)).map(Number);
}

function kill(pid: number): void {
  try {
    process.kill(pid, "SIGKILL");
  } catch {
    // It ended by itself.
  }
}

function settingsOf(pid: string): readonly string[] {
  try {
    return readFileSync(`/proc/${pid}/environ`, "utf8").split("\0");
  } catch {
    // It ended meanwhile, or it is somebody else's.
    return [];
  }
}

/** The first line with these words; what follows is read, and told to nobody. */
function lineWith(stream: Readable | null, words: string): Promise<string> {
  if (!stream) throw new Error("the server has no standard output");
  return new Promise((found) => {
    createInterface({ input: stream }).on("line", (line) => {
      if (line.includes(words)) found(line);
    });
  });
}

async function firstLine(child: ChildProcess): Promise<string> {
  if (!child.stdout) throw new Error("the server has no standard output");
  const lines = createInterface({ input: child.stdout });
  const line = once(lines, "line").then(([text]) => String(text));
  const gone = once(child, "exit").then(([code]) => {
    throw new Error(`the server ended at once: ${code}`);
  });
  return Promise.race([line, gone]);
}
