/** The page as a person uses it: finds things by role and name, presses, drags and types. Reads where things are from the page's
 * own words, and never changes anything by them. */

import type { Page as Sheet } from "playwright-core";
import { vi } from "vitest";
import type { CommandContext, Commands } from "../../src/commands/command.ts";
import type { StateDocument } from "../../src/model/generated/protocol.ts";
import type { Box, Point } from "../../src/model/geometry.ts";
import { childBox, portPlaces, rootSize } from "../../src/model/layout_reader.ts";
import { lineage } from "../../src/model/path.ts";
import type { Page } from "../../src/store/page/page.ts";
import { PATIENCE } from "./patience.ts";
import type { Server } from "./server.ts";

declare global {
  interface Window {
    /** What the page tells journeys and benches. */
    readonly __rafcon: {
      readonly page: Page;
      readonly commands: Commands;
      readonly context: () => CommandContext;
    };
  }
}

/** A state with its place among its siblings. */
interface Found {
  readonly state: StateDocument;
  readonly index: number;
}

export class App {
  readonly sheet: Sheet;
  readonly server: Server;

  constructor(sheet: Sheet, server: Server) {
    this.sheet = sheet;
    this.server = server;
  }

  /** Comes by the owner's link. */
  async enter(): Promise<void> {
    await this.sheet.goto(this.server.link);
    await this.connected();
  }

  /** Comes by name and password. */
  async logIn(user: string, password: string): Promise<void> {
    await this.sheet.goto(this.server.url);
    await this.sheet.getByLabel("User").fill(user);
    await this.sheet.getByLabel("Password").fill(password);
    await this.sheet.keyboard.press("Enter");
    await this.connected();
  }

  /** Waits until the page is connected, as somebody, and its panels stand: from then on it listens to keys. */
  async connected(): Promise<void> {
    await vi.waitUntil(
      () => this.sheet.evaluate(() => window.__rafcon?.page.server.link.value.state === "up"),
      PATIENCE,
    );
    await this.sheet.locator(".dock-tab").first().waitFor({ state: "attached" });
  }

  /** Opens a machine of the project by the dialog, and waits until it is shown. */
  async open(name: string): Promise<void> {
    await this.sheet.keyboard.press("Control+o");
    const dialog = this.sheet.getByRole("dialog", { name: "Open a machine" });
    await dialog.getByRole("treeitem", { name, exact: true }).dblclick();
    await this.until(
      ({ tab, canvas }, file) =>
        canvas !== null && tab?.session.status.value?.summary.file?.path === file,
      name,
    );
    await this.drawn();
  }

  /** Waits until a machine without a drawing is arranged: until then its states are elsewhere. */
  private async arranged(): Promise<void> {
    await this.until(({ tab }) => tab?.session.proposal?.isDue.value !== true, null);
  }

  /** Waits until the page has drawn what it is now: sizes are known, and the camera stands. */
  async drawn(): Promise<void> {
    await this.arranged();
    await this.sheet.evaluate(
      () =>
        new Promise<void>((done) => {
          requestAnimationFrame(() => requestAnimationFrame(() => done()));
        }),
    );
  }

  get canvas() {
    return this.sheet.getByRole("application", { name: "State machine" });
  }

  /** Presses a key while the canvas has the focus. */
  async press(key: string): Promise<void> {
    await this.canvas.focus();
    await this.sheet.keyboard.press(key);
  }

  /** Chooses a command of a menu in the bar. */
  async menu(menu: string, item: string): Promise<void> {
    await this.sheet.getByRole("menubar").getByRole("menuitem", { name: menu }).click();
    const keysMayFollow = new RegExp(`^${item}( \\S+)?$`);
    await this.sheet.getByRole("menu").getByRole("menuitem", { name: keysMayFollow }).click();
  }

  /** Does a command by the palette, by its whole title. */
  async command(title: string): Promise<void> {
    await this.sheet.keyboard.press("Control+Shift+p");
    const palette = this.sheet.getByRole("dialog", { name: "Search everything" });
    await palette.getByRole("combobox").pressSequentially(title);
    await palette.getByRole("option", { name: title }).first().click();
  }

  /** Brings a panel to the front. */
  async panel(title: string): Promise<void> {
    await this.sheet.getByRole("tab", { name: title, exact: true }).click();
  }

  /** Waits until the page's own state is so. It is asked from here: the page lets nobody evaluate texts in it. */
  async until<T>(
    wanted: (context: CommandContext, argument: T) => boolean,
    argument: T,
  ): Promise<void> {
    const text = `(${wanted.toString()})(window.__rafcon.context(), ${JSON.stringify(argument)})`;
    await vi.waitUntil(() => this.sheet.evaluate<boolean>(text), PATIENCE);
  }

  /** The names of the children of a state, or of the root. */
  async children(path?: string): Promise<readonly string[]> {
    return this.sheet.evaluate((at) => {
      const machine = window.__rafcon.context().tab?.session.machine;
      if (!machine) return [];
      return machine.children(at ?? machine.root).map((child) => machine.state(child)?.name ?? "");
    }, path);
  }

  /** The path of the only state with this name. */
  async path(name: string): Promise<string> {
    return this.sheet.evaluate((wanted) => {
      const machine = window.__rafcon.context().tab?.session.machine;
      const found = [...(machine?.paths() ?? [])].filter(
        (path) => machine?.state(path)?.name === wanted,
      );
      const [path] = found;
      if (!path || found.length > 1) throw new Error(`${found.length} states are called ${wanted}`);
      return path;
    }, name);
  }

  async state(path: string): Promise<StateDocument> {
    const found = await this.sheet.evaluate(
      (at) => window.__rafcon.context().tab?.session.machine.state(at),
      path,
    );
    if (!found) throw new Error(`there is no state ${path}`);
    return found;
  }

  /** What is selected, by keys: `state:A/B`. */
  async selection(): Promise<readonly string[]> {
    return this.sheet.evaluate(() => [
      ...(window.__rafcon.context().tab?.view.selection.value ?? []),
    ]);
  }

  /** Where a state is on the screen, as the file says. */
  async box(path: string): Promise<Box> {
    return this.onScreen(await this.worldBox(path));
  }

  /** The point of the screen with these coordinates inside a state. */
  async spot(path: string, x: number, y: number): Promise<Point> {
    const box = await this.worldBox(path);
    return this.onScreen({ x: box.x + x, y: box.y + y, width: 0, height: 0 });
  }

  /** A place on a state that is neither its name nor a port nor a child: near its lower left corner. */
  async ground(path: string): Promise<Point> {
    const box = await this.box(path);
    return { x: box.x + box.width * 0.3, y: box.y + box.height - Math.min(12, box.height * 0.2) };
  }

  /** Selects a state by a click. */
  async select(path: string): Promise<void> {
    await this.click(await this.ground(path));
    await this.selected(`state:${path}`);
  }

  /** Waits until exactly these are selected. */
  async selected(...keys: readonly string[]): Promise<void> {
    const isSo = ({ tab }: CommandContext, wanted: readonly string[]) => {
      const found = [...(tab?.view.selection.value ?? [])];
      return found.length === wanted.length && wanted.every((key) => found.includes(key));
    };
    await this.until(isSo, keys).catch(async (cause: unknown) => {
      const selected = (await this.selection()).join(", ") || "nothing";
      throw new Error(`${keys.join(", ")} should be selected, but ${selected} is`, { cause });
    });
  }

  /** Waits until everything that was done has its answer. */
  async settled(): Promise<void> {
    await this.until(({ tab }) => tab?.session.pending.value.length === 0, null);
  }

  /** The middle of a state on the screen. */
  async middle(path: string): Promise<Point> {
    const box = await this.box(path);
    return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
  }

  /** Where a port is on the screen: `income`, or the name of an outcome, input, output or scoped variable. */
  async port(
    path: string,
    kind: "income" | "outcome" | "input" | "output" | "scoped_variable",
    name = "income",
  ): Promise<Point> {
    const state = await this.state(path);
    const box = await this.worldBox(path);
    const place = portPlaces(state, path, box).find(
      (port) => port.kind === kind && port.name === name,
    );
    if (!place) throw new Error(`${path} has no ${kind} ${name}`);
    const at = { x: box.x + place.at.x, y: box.y + place.at.y, width: 0, height: 0 };
    return this.onScreen(at);
  }

  /** Presses at one point, goes to another, and lets go there. */
  async drag(from: Point, to: Point, before?: () => Promise<void>): Promise<void> {
    const { mouse } = this.sheet;
    await mouse.move(from.x, from.y);
    await mouse.down();
    await mouse.move((from.x * 2 + to.x) / 3, (from.y * 2 + to.y) / 3, { steps: 4 });
    await mouse.move(to.x, to.y, { steps: 6 });
    await before?.();
    await mouse.up();
  }

  /** What is written for the user lately: refusals, what was done. */
  async showsText(words: string | RegExp): Promise<void> {
    await this.sheet.getByText(words).first().waitFor();
  }

  /** The name of the step that was made last. */
  async lastStep(): Promise<string> {
    await this.settled();
    return this.sheet.evaluate(
      () => window.__rafcon.context().tab?.session.steps.value.steps.at(-1)?.name ?? "",
    );
  }

  /** The text that the clipboard has. */
  async copied(): Promise<string> {
    return this.sheet.evaluate(() => navigator.clipboard.readText());
  }

  async click(at: Point, button: "left" | "right" = "left"): Promise<void> {
    await this.sheet.mouse.click(at.x, at.y, { button });
  }

  /** A state's box in the root's coordinates: the sum of the positions on the way to it. */
  private async worldBox(path: string): Promise<Box> {
    await this.arranged();
    const found: readonly Found[] = await this.sheet.evaluate(
      (paths) => {
        const machine = window.__rafcon.context().tab?.session.machine;
        return paths.map((at, level) => {
          const state = machine?.state(at);
          const above = paths[level - 1];
          if (!machine || !state) throw new Error(`there is no state ${at}`);
          return { state, index: above ? machine.children(above).indexOf(at) : 0 };
        });
      },
      [...lineage(path)],
    );
    const [root, ...inner] = found;
    if (!root) throw new Error(`${path} is no path`);
    let box: Box = { x: 0, y: 0, ...rootSize(root.state) };
    for (const { state, index } of inner) {
      const child = childBox(state, index, box);
      box = { ...child, x: box.x + child.x, y: box.y + child.y };
    }
    return box;
  }

  /** Place of a box on the screen, once camera and canvas have not moved for two frames: a new panel or banner moves both. */
  private async onScreen(world: Box): Promise<Box> {
    const { camera, left, top } = await this.sheet.evaluate(async () => {
      const look = () => {
        const view = window.__rafcon.context().tab?.view.camera.value;
        const canvas = document.querySelector('[role="application"][aria-label="State machine"]');
        if (!view || !canvas) throw new Error("no machine is shown");
        const frame = canvas.getBoundingClientRect();
        return { camera: view, left: frame.left, top: frame.top };
      };
      const frame = () => new Promise((done) => requestAnimationFrame(done));
      for (let before = look(); ; ) {
        await frame();
        await frame();
        const now = look();
        const isStill =
          now.camera === before.camera && now.left === before.left && now.top === before.top;
        if (isStill) return now;
        before = now;
      }
    });
    return {
      x: left + (world.x - camera.x) * camera.scale,
      y: top + (world.y - camera.y) * camera.scale,
      width: world.width * camera.scale,
      height: world.height * camera.scale,
    };
  }
}
