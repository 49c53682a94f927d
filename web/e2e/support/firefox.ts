/** Firefox, driven by WebDriver BiDi: finds things by role and name, presses, drags and types. */

import { type ChildProcess, spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import type { Page as Sheet } from "playwright-core";
import { vi } from "vitest";
import WebSocket from "ws";
import type { Box, Point } from "../../src/model/geometry.ts";
import { PATIENCE } from "./patience.ts";

export const FIREFOX = process.env["RAFCON_FIREFOX"] ?? "/usr/bin/firefox-esr";

const SIZE = { width: 1280, height: 800 };
/** Keys as WebDriver writes them. */
const KEYS: Readonly<Record<string, string>> = {
  Control: "\uE009",
  Shift: "\uE008",
  Alt: "\uE00A",
  Enter: "\uE007",
  Escape: "\uE00C",
  Home: "\uE011",
  End: "\uE010",
  F2: "\uE032",
  F7: "\uE037",
};

type Answer = Readonly<Record<string, unknown>>;

/** An element that was found. */
interface Found {
  readonly sharedId: string;
}

/** How one element is found. */
type Step = { readonly role: string; readonly name?: string } | { readonly css: string };

export class Firefox {
  readonly #process: ChildProcess;
  readonly #folder: string;
  readonly #socket: WebSocket;
  readonly #waiting = new Map<
    number,
    { done: (answer: Answer) => void; failed: (why: Error) => void }
  >();
  #id = 0;
  #context = "";

  private constructor(process: ChildProcess, folder: string, socket: WebSocket) {
    [this.#process, this.#folder, this.#socket] = [process, folder, socket];
    socket.on("message", (text) => this.#hear(String(text)));
  }

  /** A fresh Firefox with a profile of its own, without a window. */
  static async launch(): Promise<Firefox> {
    const folder = mkdtempSync(join(tmpdir(), "rafcon-firefox-"));
    const words = [
      "--headless",
      "--no-remote",
      "--profile",
      folder,
      "--remote-debugging-port",
      "0",
    ];
    const env = { ...process.env, MOZ_HEADLESS_WIDTH: "1280", MOZ_HEADLESS_HEIGHT: "900" };
    const child = spawn(FIREFOX, [...words, "about:blank"], {
      stdio: ["ignore", "ignore", "pipe"],
      env,
    });
    const url = await address(child);
    const socket = new WebSocket(`${url}/session`);
    await new Promise((open, failed) => {
      socket.once("open", open);
      socket.once("error", failed);
    });
    const firefox = new Firefox(child, folder, socket);
    await firefox.#ask("session.new", { capabilities: {} });
    const { contexts } = await firefox.#ask("browsingContext.getTree", {});
    firefox.#context = (contexts as { context: string }[])[0]?.context ?? "";
    await firefox.#ask("script.addPreloadScript", {
      functionDeclaration: "() => { window.__rafcon = null; }",
    });
    await firefox.#ask("browsingContext.setViewport", {
      context: firefox.#context,
      viewport: SIZE,
    });
    return firefox;
  }

  async close(): Promise<void> {
    const gone = new Promise((over) => this.#process.once("exit", over));
    this.#socket.close();
    this.#process.kill("SIGKILL");
    await gone;
    rmSync(this.#folder, { recursive: true, force: true, maxRetries: 5 });
  }

  async goto(url: string): Promise<void> {
    await this.#ask("browsingContext.navigate", { context: this.#context, url, wait: "complete" });
  }

  /** What a function without names from around it gives in the page. */
  async evaluate<T>(look: ((argument: never) => T) | string, argument?: unknown): Promise<T> {
    const text =
      typeof look === "string" ? look : `(${look.toString()})(${JSON.stringify(argument ?? null)})`;
    const expression = `(async () => JSON.stringify((await (${text})) ?? null))()`;
    const target = { context: this.#context };
    const reply = await this.#ask("script.evaluate", { expression, target, awaitPromise: true });
    const { type, result, exceptionDetails } = reply as Answer & { result?: { value: string } };
    if (type !== "success") throw new Error(JSON.stringify(exceptionDetails));
    return JSON.parse(result?.value ?? "null") as T;
  }

  /** The part of Playwright's words that [`App`] needs. */
  get sheet(): Sheet {
    const mouse = {
      click: (x: number, y: number) => this.point([move({ x, y }), ...PRESS]),
      move: (x: number, y: number, { steps = 1 } = {}) =>
        this.point([{ ...move({ x, y }), duration: 10 * steps }]),
      down: () => this.point(PRESS.slice(0, 1)),
      up: () => this.point(PRESS.slice(1)),
    };
    const keyboard = {
      press: (keys: string) => this.press(keys),
      type: (text: string) => this.type(text),
    };
    const sheet = {
      goto: (url: string) => this.goto(url),
      evaluate: (look: () => unknown, argument: unknown) => this.evaluate(look, argument),
      getByRole: (role: string, { name }: { name?: string } = {}) =>
        new Place(this, [{ role, ...(name === undefined ? {} : { name }) }]),
      locator: (css: string) => new Place(this, [{ css }]),
      mouse,
      keyboard,
    };
    return sheet as unknown as Sheet;
  }

  /** The first thing that is found by these steps, each inside of what the one before found; waits until it is there. */
  async find(steps: readonly Step[]): Promise<Found> {
    const value = { type: "string", value: JSON.stringify(steps) };
    const asked = {
      functionDeclaration: LOOK,
      arguments: [value],
      target: { context: this.#context },
      awaitPromise: false,
      resultOwnership: "root",
    };
    const look = async () => {
      const { result } = (await this.#ask("script.callFunction", asked)) as { result?: Found };
      return result?.sharedId === undefined ? undefined : result;
    };
    return vi.waitUntil(look, PATIENCE);
  }

  async call<T>(found: Found, text: string): Promise<T> {
    const asked = {
      functionDeclaration: text,
      arguments: [{ sharedId: found.sharedId }],
      target: { context: this.#context },
      awaitPromise: false,
    };
    const { result } = (await this.#ask("script.callFunction", asked)) as {
      result?: { value: string };
    };
    return JSON.parse(result?.value ?? "null") as T;
  }

  /** Presses keys together: `Control+Shift+p`. */
  async press(keys: string): Promise<void> {
    const all = keys.split("+").map((key) => KEYS[key] ?? key);
    const down = all.map((value) => ({ type: "keyDown", value }));
    const up = all.toReversed().map((value) => ({ type: "keyUp", value }));
    await this.#act({ type: "key", id: "keys", actions: [...down, ...up] });
  }

  async type(text: string): Promise<void> {
    const actions = [...text].flatMap((letter) => {
      const value = letter === "\n" ? KEYS["Enter"] : letter;
      return [
        { type: "keyDown", value },
        { type: "keyUp", value },
      ];
    });
    await this.#act({ type: "key", id: "keys", actions });
  }

  point(actions: readonly unknown[]): Promise<Answer> {
    const parameters = { pointerType: "mouse" };
    return this.#act({ type: "pointer", id: "mouse", parameters, actions });
  }

  /** A picture of the page: PNG. */
  async picture(): Promise<Buffer> {
    const { data } = await this.#ask("browsingContext.captureScreenshot", {
      context: this.#context,
    });
    return Buffer.from(String(data), "base64");
  }

  #act(source: unknown): Promise<Answer> {
    return this.#ask("input.performActions", { context: this.#context, actions: [source] });
  }

  #ask(method: string, params: Answer): Promise<Answer> {
    this.#id += 1;
    const id = this.#id;
    return new Promise((done, failed) => {
      this.#waiting.set(id, { done, failed });
      this.#socket.send(JSON.stringify({ id, method, params }));
    });
  }

  #hear(text: string): void {
    const reply = JSON.parse(text) as Answer & { id?: number; result?: Answer };
    const waiting = this.#waiting.get(reply.id ?? 0);
    this.#waiting.delete(reply.id ?? 0);
    if (reply["type"] === "error")
      waiting?.failed(new Error(`${reply["error"]}: ${reply["message"]}`));
    else waiting?.done(reply.result ?? {});
  }
}

const PRESS = [
  { type: "pointerDown", button: 0 },
  { type: "pointerUp", button: 0 },
] as const;

function move(at: Found | Point) {
  if ("sharedId" in at) {
    const origin = { type: "element", element: at };
    return { type: "pointerMove", x: 0, y: 0, origin };
  }
  return { type: "pointerMove", x: Math.round(at.x), y: Math.round(at.y) };
}

/** Looks things up in the page: Firefox builds its tree of roles and names anew for each question, which resumes to a second. */
const LOOK = `(json) => {
  const native = {
    button: "button",
    dialog: "dialog",
    region: "section",
    textbox: "textarea, input:not([type]), input[type=text], input[type=password]",
  };
  const text = (element) => (element?.textContent ?? "").trim().replaceAll(/\\s+/g, " ");
  const named = (element) => {
    const by = element.getAttribute("aria-labelledby");
    if (by) return by.split(" ").map((id) => text(document.getElementById(id))).join(" ");
    const label = element.getAttribute("aria-label");
    return label ?? (element.labels?.length ? text(element.labels[0]) : text(element));
  };
  const found = (inside, { css, role, name }) => {
    if (css) return inside.querySelector(css);
    const all = [...inside.querySelectorAll('[role="' + role + '"], ' + (native[role] ?? "_"))];
    const fits = (element) =>
      (element.getAttribute("role") ?? role) === role &&
      element.checkVisibility() &&
      (name === undefined || named(element) === name);
    return all.find(fits) ?? null;
  };
  return JSON.parse(json).reduce((inside, step) => inside && found(inside, step), document);
}`;

const BOX = `(element) => {
  const { x, y, width, height } = element.getBoundingClientRect();
  return JSON.stringify({ x, y, width, height });
}`;

const IN_SIGHT = `(element) => {
  element.scrollIntoView({ block: "nearest" });
  return "null";
}`;

/** Something in the page, by how it is found. */
class Place {
  readonly #firefox: Firefox;
  readonly #steps: readonly Step[];

  constructor(firefox: Firefox, steps: readonly Step[]) {
    [this.#firefox, this.#steps] = [firefox, steps];
  }

  getByRole(role: string, { name }: { name?: string } = {}): Place {
    return new Place(this.#firefox, [
      ...this.#steps,
      { role, ...(name === undefined ? {} : { name }) },
    ]);
  }

  first(): this {
    return this;
  }

  async waitFor(): Promise<void> {
    await this.#firefox.find(this.#steps);
  }

  async click(): Promise<void> {
    const found = await this.#firefox.find(this.#steps);
    await this.#firefox.call(found, IN_SIGHT);
    await this.#firefox.point([move(found), ...PRESS]);
  }

  async focus(): Promise<void> {
    const found = await this.#firefox.find(this.#steps);
    await this.#firefox.call(found, "(element) => { element.focus(); return 'null'; }");
  }

  async fill(text: string): Promise<void> {
    await this.click();
    await this.#firefox.press("Control+a");
    await this.#firefox.type(text);
  }

  async pressSequentially(text: string): Promise<void> {
    await this.focus();
    await this.#firefox.type(text);
  }

  async boundingBox(): Promise<Box> {
    return this.#firefox.call<Box>(await this.#firefox.find(this.#steps), BOX);
  }
}

/** Where it listens, as it says itself. */
async function address(child: ChildProcess): Promise<string> {
  if (!child.stderr) throw new Error("Firefox has no error output");
  const lines = createInterface({ input: child.stderr });
  for await (const line of lines) {
    const found = line.match(/WebDriver BiDi listening on (ws:\S+)/)?.[1];
    if (found) return found;
  }
  throw new Error(`Firefox ended at once: is ${FIREFOX} there? RAFCON_FIREFOX names another one`);
}
