/** The canvas without a browser, for tests: a machine in short text, the real interaction controller, tools, plans and places. Points may be
 * given on the screen, as a state (`A`, its middle) or as a port (`A.ok`, `A.income`). */

import { signal } from "@preact/signals-core";
import { elementOf, keyOf } from "../../model/element.ts";
import type { Edit } from "../../model/generated/protocol.ts";
import { centre, type Point } from "../../model/geometry.ts";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import type {
  EditAnswer,
  MachineSession,
  PendingEdit,
} from "../../store/document/machine_session.ts";
import { OptimisticDocument } from "../../store/document/optimistic_document.ts";
import { predictedWrites } from "../../store/document/predict/predict.ts";
import type { Dragged } from "../../store/page/dragged.ts";
import { newView, type SessionView, select, selected } from "../../store/page/view.ts";
import { screenFromWorld } from "../camera/camera.ts";
import { InteractionController } from "../interaction.ts";
import { type LayoutTree, layoutTreeOf } from "../layout/layout_tree.ts";
import { NO_OVERLAY } from "../overlay.ts";
import type { Pointer } from "../tools/gesture.ts";
import type { Wheel } from "../tools/pan.ts";

export type Where = string | Point;

interface Keys {
  readonly shift?: boolean;
  readonly ctrl?: boolean;
  readonly alt?: boolean;
}

/** A machine session without a server: what can be predicted is done at once, the rest is only kept. */
export class PlainMachineSession implements MachineSession {
  readonly id = "test";
  fixed: string | null = null;
  readonly machine: OptimisticDocument;
  readonly version = signal(0);
  readonly status = signal(null);
  readonly people = signal([]);
  readonly pending = signal<readonly PendingEdit[]>([]);
  readonly steps: MachineSession["steps"] = signal({
    now: 0,
    steps: [],
  } as unknown as MachineSession["steps"]["value"]);
  readonly revision = signal(0);
  readonly problems = signal([]);
  readonly isChecked = signal(true);
  readonly check = async () => [];
  readonly made: { readonly name: string; readonly edit: Edit }[] = [];

  constructor(text: string, library: string | null = null) {
    const content = library === null ? undefined : machineOf(sketch(library));
    this.machine = new OptimisticDocument(sketch(text), () => content);
  }

  readonly onChange = () => () => {};

  edit(name: string, edit: Edit): Promise<EditAnswer> {
    this.made.push({ name, edit });
    const writes = predictedWrites(this.machine, edit);
    if (writes) this.machine.transact(() => this.machine.applyOptimistic(writes));
    if (writes) this.version.value += 1;
    return Promise.resolve({ revision: this.made.length });
  }

  readonly undo = () => Promise.resolve({ refused: "not here" });
  readonly redo = () => Promise.resolve({ refused: "not here" });
  readonly jump = () => Promise.resolve({ refused: "not here", code: "not_here" });
  readonly stepChange = () => undefined;
  readonly named = (text: string) => text;
  readonly loadLibrary = () => Promise.resolve();
  readonly close = () => {};
}

export class Driver {
  readonly session: PlainMachineSession;
  readonly view: SessionView = newView();
  readonly controller: InteractionController;
  readonly refusals: string[] = [];
  readonly commands: string[] = [];
  readonly renamed: string[] = [];
  wheel: "zoom" | "pan" = "zoom";
  #at: Point = { x: 0, y: 0 };
  #keys: Keys = {};

  constructor(text: string, library: string | null) {
    this.session = new PlainMachineSession(text, library);
    this.controller = new InteractionController({
      page: { server: { link: signal({ state: "connecting" }) } },
      tab: { session: this.session, view: this.view, run: signal(null) },
      size: () => ({ width: 1000, height: 800 }),
      wheel: () => this.wheel,
      fly: (to) => {
        this.view.camera.value = to;
      },
      heading: () => this.view.camera.value,
      run: ({ command, argument }) => {
        this.commands.push(`${command} ${JSON.stringify(argument)}`);
      },
      refuse: (reason) => this.refusals.push(reason),
      rename: (path) => this.renamed.push(path),
    });
  }

  /** A point of the view. */
  point(where: Where): Point {
    if (typeof where !== "string") return where;
    const [name = "", port] = where.split(".");
    const { machine } = this.session;
    const paths = [name, ...machine.paths()];
    const path = paths.find(
      (each) => machine.state(each) && (each === name || each.endsWith(`/${name}`)),
    );
    const box = path === undefined ? undefined : this.controller.layout().box(path);
    if (path === undefined || !box) throw new Error(`no state ${where}`);
    if (port === undefined) return screenFromWorld(this.view.camera.value, centre(box));
    const found = this.controller
      .layout()
      .ports(path)
      .find((each) => each.name === port);
    if (!found) throw new Error(`no port ${where}`);
    return screenFromWorld(this.view.camera.value, found.at);
  }

  #pointer(): Pointer {
    const { shift = false, ctrl = false, alt = false } = this.#keys;
    return { ...this.#at, shift, ctrl, alt };
  }

  /** After the answers to all edits. */
  async answered(): Promise<this> {
    for (let turn = 0; turn < 3; turn++) await Promise.resolve();
    return this;
  }

  press(
    where: Where,
    keys: Keys = {},
    how: { readonly touch?: number; readonly pans?: boolean } = {},
  ): this {
    this.#at = this.point(where);
    this.#keys = keys;
    const finger = how.touch === undefined ? {} : { finger: how.touch };
    const press = { ...this.#pointer(), isTouch: how.touch !== undefined };
    this.controller.press(press, { pans: how.pans ?? false, ...finger });
    return this;
  }

  /** In several steps, as pointers move. */
  drag(where: Where, keys: Keys = this.#keys, finger?: number): this {
    const [from, to] = [this.#at, this.point(where)];
    this.#keys = keys;
    for (const part of [0.3, 0.7, 1]) {
      this.#at = { x: from.x + (to.x - from.x) * part, y: from.y + (to.y - from.y) * part };
      this.controller.move(this.#pointer(), finger);
    }
    return this;
  }

  by(x: number, y: number, keys?: Keys): this {
    return this.drag({ x: this.#at.x + x, y: this.#at.y + y }, keys);
  }

  release(finger?: number): this {
    this.controller.release(this.#pointer(), finger);
    return this;
  }

  click(where: Where, keys: Keys = {}): this {
    return this.press(where, keys).release();
  }

  doubleClick(where: Where): this {
    this.click(where).click(where);
    this.controller.doubleClick(this.#pointer());
    return this;
  }

  hover(where: Where): this {
    this.#at = this.point(where);
    this.controller.move(this.#pointer());
    return this;
  }

  key(key: string, keys: Keys = {}): this {
    const { shift = false, ctrl = false, alt = false } = keys;
    this.controller.key({ key, shift, ctrl, alt });
    return this;
  }

  turn(where: Where, wheel: Partial<Wheel>): this {
    this.#at = this.point(where);
    const still = { deltaX: 0, deltaY: 0, deltaMode: 0, ctrl: false, shift: false };
    this.controller.turn(this.#at, { ...still, ...wheel });
    return this;
  }

  bring(dragged: Dragged, where: Where): this {
    this.#at = this.point(where);
    this.controller.bring(dragged, this.#pointer());
    return this;
  }

  drop(): this {
    this.controller.drop();
    return this;
  }

  select(...keys: readonly string[]): this {
    select(
      this.view,
      keys.flatMap((key) => elementOf(key) ?? []),
    );
    return this;
  }

  /** Whether nothing of a gesture is left. */
  isClear(): boolean {
    return this.controller.doing === null && this.controller.overlay.value === NO_OVERLAY;
  }

  /** Where everything shows, with what the gesture would do. */
  shown(): LayoutTree {
    const { modes, contents } = this.view;
    const view = { modes: modes.value, contents: contents.value };
    return layoutTreeOf(this.session.machine, view, this.controller.overlay.value.provisional);
  }

  /** Where a state is in its container now: `20 30 80 60`. */
  box(id: string): string {
    const { machine } = this.session;
    const path = [...machine.paths()].find((each) => each === id || each.endsWith(`/${id}`));
    const box = path && this.controller.layout().box(path);
    if (!box) return "none";
    return [box.x, box.y, box.width, box.height].map(short).join(" ");
  }

  selection(): string {
    return selected(this.view).map(keyOf).join(" ");
  }

  /** What was made, what is selected, what was refused: one line each. */
  text(): string {
    const lines = this.session.made.map(({ name, edit }) => `${name}: ${editsText(edit)}`);
    for (const reason of this.refusals) lines.push(`refused: ${reason}`);
    for (const command of this.commands) lines.push(`run: ${command}`);
    lines.push(`selected: ${this.selection() || "nothing"}`);
    return lines.join("\n");
  }
}

/** All libraries of the machine, if it has any, are the one in the second text. */
export function driver(text: string = ARM, library: string | null = null): Driver {
  return new Driver(text, library);
}

/** A machine for tests, drawn one to one on the screen. */
export const ARM = `
  R "Root" hierarchy 0 0 900 700 outcome done input speed:int=3 scoped found:int
    A "Scan" execution 50 100 200 150 outcome ok outcome lost output pose:int
    B "Grasp" execution 400 100 200 150 outcome ok input pose:int
    C "Box" hierarchy 100 350 500 300 outcome ok
      D "Inner" execution 50 80 150 100 outcome ok
    R > A
    A.ok > B
    B.ok > R.done
`;

function editsText(edit: Edit): string {
  if (edit.edit === "batch") return edit.edits.map(editsText).join("; ");
  const { edit: word, ...rest } = edit;
  return `${word} ${Object.values(rest).map(valueText).join(" ")}`;
}

function valueText(value: unknown): string {
  if (typeof value === "number") return short(value);
  if (typeof value === "string") return value;
  return JSON.stringify(value, (_, inner) =>
    typeof inner === "number" ? Number(short(inner)) : inner,
  );
}

function short(value: number): string {
  return String(Math.round(value * 100) / 100);
}
