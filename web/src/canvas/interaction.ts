/** Interaction controller of the canvas: applies pointer, wheel and keys to one open machine, without access to the document. It
 * holds the current gesture, shows a preview of its result, and sends the edit when the gesture is complete. */

import { computed, type ReadonlySignal, type Signal, signal } from "@preact/signals-core";
import { type ElementRef, keyOf } from "../model/element.ts";
import { type Box, boundsOf, intersects, type Point, type Size } from "../model/geometry.ts";
import { isContainer } from "../model/machine.ts";
import { move as movePlan } from "../plan/move.ts";
import { isRefused, type Planned, refused } from "../plan/plan.ts";
import { rename as renamePlan } from "../plan/states.ts";
import { applyPlan } from "../store/page/apply_plan.ts";
import type { CommandCall } from "../store/page/command_arguments.ts";
import type { Dragged } from "../store/page/dragged.ts";
import type { OpenTab, Page } from "../store/page/page.ts";
import { whyFixed } from "../store/page/rights.ts";
import { type Camera, select, selected, toggle } from "../store/page/view.ts";
import { visibleBox, zoomedAt } from "./camera/camera.ts";
import { filling, revealing } from "./camera/framing.ts";
import { handleKey, isNudge, type KeyPress } from "./canvas_keys.ts";
import { ghostBox } from "./ghost.ts";
import { hitAt, routeOf, statesAt } from "./hit/hit.ts";
import type { CanvasHit } from "./hit/look.ts";
import { extentOn } from "./hit/shown.ts";
import { type LayoutTree, layoutTreeOf } from "./layout/layout_tree.ts";
import { NO_OVERLAY, type Overlay, showing } from "./overlay.ts";
import { DETAIL } from "./scene/detail.ts";
import { connecting } from "./tools/connect.ts";
import { bringing } from "./tools/drop.ts";
import { firstPort } from "./tools/first_port.ts";
import {
  type Gesture,
  type GestureResult,
  inState,
  type Pointer,
  type ToolContext,
} from "./tools/gesture.ts";
import { type Fingers, panning, pinched, type Wheel, wheeled } from "./tools/pan.ts";
import { cursorAt, type Press, pressing } from "./tools/press.ts";
import { workingContainerOf } from "./tools/working_container.ts";

/** Services that the controller needs from the canvas and the page. */
export interface InteractionHost {
  readonly page: { readonly server: Pick<Page["server"], "link"> };
  readonly tab: OpenTab;
  readonly size: () => Size;
  /** Action of the wheel without a modifier key. */
  readonly wheel: () => "zoom" | "pan";
  /** Moves the camera, at once or as an animation. */
  readonly fly: (to: Camera) => void;
  /** Goal of the camera's flight; the current camera without a flight. */
  readonly heading: () => Camera;
  readonly run: (call: CommandCall) => void;
  /** Shows the reason why an action is impossible. */
  readonly refuse: (reason: string) => void;
  readonly rename: (path: string) => void;
}

/** Steps of states by keyboard that were not applied yet, in the coordinates of their container. */
interface Nudging {
  readonly paths: readonly string[];
  readonly by: Point;
  readonly timer: ReturnType<typeof setTimeout>;
}

/** Longest pause between steps that become one edit, in ms. */
const NUDGED_MS = 500;

interface Touch {
  readonly id: number;
  readonly at: Point;
}

/** Gestures that do not edit. */
const HARMLESS: ReadonlySet<string> = new Set(["press", "pan", "band"]);

const MOUSE_TOLERANCE = 8;
const TOUCH_TOLERANCE = 16;

export class InteractionController {
  readonly overlay: Signal<Overlay> = signal(NO_OVERLAY);
  readonly cursor: Signal<string> = signal("default");
  /** The innermost state that fills the view. The user works in it. */
  readonly workingContainer: ReadonlySignal<string>;
  readonly #host: InteractionHost;
  #gesture: Gesture | null = null;
  #nudging: Nudging | null = null;
  #pointer: Pointer | null = null;
  #touches: readonly Touch[] = [];
  #pinch: { readonly camera: Camera; readonly from: Fingers } | null = null;

  constructor(host: InteractionHost) {
    this.#host = host;
    const { session, view } = host.tab;
    this.workingContainer = computed(() => {
      session.version.value;
      view.contents.value;
      return this.#workingContainerAt(view.camera.value);
    });
  }

  /** Name of the current gesture. */
  get doing(): string | null {
    return this.#gesture?.name ?? null;
  }

  /** Moves states a little. A series of steps becomes one edit when it ends. */
  nudge(paths: readonly string[], by: Point): void {
    const before = this.#nudging;
    const isSame = before?.paths.join() === paths.join();
    if (before && !isSame) this.flush();
    const from = isSame && before ? before.by : { x: 0, y: 0 };
    const total = { x: from.x + by.x, y: from.y + by.y };
    const plan = movePlan(this.#host.tab.session.machine, paths, total);
    clearTimeout(before?.timer);
    if (isRefused(plan) || this.#whyFixed() !== null) {
      this.#nudging = null;
      this.apply(plan);
      return;
    }
    this.overlay.value = showing(plan, new Set(paths));
    const timer = setTimeout(() => this.flush(), NUDGED_MS);
    this.#nudging = { paths, by: total, timer };
  }

  /** Applies the pending series of small steps. */
  flush(): void {
    const nudging = this.#nudging;
    if (!nudging) return;
    this.#nudging = null;
    clearTimeout(nudging.timer);
    this.overlay.value = NO_OVERLAY;
    this.apply(movePlan(this.#host.tab.session.machine, nudging.paths, nudging.by));
  }

  /** Layout without the current gesture. */
  layout(): LayoutTree {
    const { session, view } = this.#host.tab;
    const [modes, contents] = [view.modes.peek(), view.contents.peek()];
    return layoutTreeOf(session.machine, { modes, contents });
  }

  toolContext(): ToolContext {
    const { session, view } = this.#host.tab;
    return {
      machine: session.machine,
      layout: this.layout(),
      camera: view.camera.peek(),
      size: this.#host.size(),
      look: {
        selection: view.selection.peek(),
        hovered: view.hovered.peek(),
        modes: view.modes.peek(),
        size: this.#host.size(),
      },
    };
  }

  /** The element under a point of the view. */
  at(point: Point, tolerance: number = MOUSE_TOLERANCE): CanvasHit | null {
    const { machine, layout, look, camera } = this.toolContext();
    return hitAt(layout, machine, look, camera, point, tolerance);
  }

  /** Handles a press of the button or of a finger. */
  press(press: Press, how: { readonly pans: boolean; readonly finger?: number }): void {
    this.flush();
    this.#pointer = press;
    if (how.finger !== undefined && this.#fingerDown(how.finger, press)) return;
    if (this.#gesture?.isSticky && !how.pans) {
      this.#stick(press);
      return;
    }
    if (how.pans) {
      this.#become(panning(press, this.toolContext().camera));
      return;
    }
    const hit = this.at(press, press.isTouch ? TOUCH_TOLERANCE : MOUSE_TOLERANCE);
    this.#become(pressing(hit, press, this.toolContext()));
  }

  /** A second finger cancels the gesture of the first. Both fingers zoom. */
  #fingerDown(id: number, at: Point): boolean {
    this.#touches = [...this.#touches.filter((touch) => touch.id !== id), { id, at }];
    const [one, other] = this.#touches;
    if (!one || !other) return false;
    this.cancel();
    this.#pinch = { camera: this.toolContext().camera, from: [one.at, other.at] };
    return true;
  }

  #stick(press: Press): void {
    const gesture = this.#gesture?.move(press, this.toolContext());
    if (!gesture) return;
    const marked = gesture.mark?.(this.toolContext());
    if (marked) this.#become(marked);
    else this.#complete(gesture);
  }

  move(pointer: Pointer, finger?: number): void {
    this.#pointer = pointer;
    if (finger !== undefined && this.#fingerMoved(finger, pointer)) return;
    if (this.#gesture) this.#become(this.#gesture.move(pointer, this.toolContext()));
    else if (finger === undefined) this.hover(pointer);
  }

  #fingerMoved(id: number, at: Point): boolean {
    this.#touches = this.#touches.map((touch) => (touch.id === id ? { id, at } : touch));
    const [one, other] = this.#touches;
    if (!this.#pinch || !one || !other) return false;
    const { camera, from } = this.#pinch;
    this.#host.tab.view.camera.value = pinched(camera, from, [one.at, other.at]);
    return true;
  }

  release(pointer: Pointer, finger?: number): void {
    this.#pointer = pointer;
    if (finger !== undefined) this.#touches = this.#touches.filter(({ id }) => id !== finger);
    if (this.#touches.length < 2) this.#pinch = null;
    if (!this.#gesture || this.#gesture.isSticky) return;
    this.#complete(this.#gesture);
    this.hover(pointer);
  }

  /** Handles a pointer movement over the canvas without a button. */
  hover(point: Point): void {
    const hit = this.at(point);
    const { hovered } = this.#host.tab.view;
    const before = hovered.peek();
    const now = hit?.element ?? null;
    if ((before && keyOf(before)) !== (now && keyOf(now))) hovered.value = now;
    this.cursor.value = cursorAt(hit);
  }

  /** Handles a pointer that leaves the canvas. */
  leave(): void {
    if (this.#gesture) return;
    this.#pointer = null;
    this.#host.tab.view.hovered.value = null;
  }

  doubleClick(pointer: Pointer): void {
    this.#endGesture();
    const hit = this.at(pointer);
    if (!hit) return;
    const { path } = hit.element;
    if (hit.on === "name" && this.#isOnlyName(path)) this.rename(path);
    else if (hit.on === "state" || hit.on === "name" || hit.on === "grip") this.drill(path);
  }

  /** Zooms to a state until it fills the view, and opens a closed library. */
  drill(path: string): void {
    const { session, view } = this.#host.tab;
    const isClosed = this.layout().children(path).length === 0;
    if (isClosed && session.machine.state(path)?.kind === "library") {
      view.contents.value = new Map(view.contents.peek()).set(path, true);
      void session.loadLibrary(path);
    }
    this.fit([path]);
  }

  /** True if the name does not cover the content. The name of a closed container fills it, and a double click there must open it. */
  #isOnlyName(path: string): boolean {
    const state = this.#host.tab.session.machine.state(path);
    const box = this.layout().box(path);
    if (!state || !box) return false;
    if (!isContainer(state) && state.kind !== "library") return true;
    const isOpen = this.layout().children(path).length > 0;
    return isOpen && extentOn(this.#host.tab.view.camera.peek(), box) >= DETAIL.content;
  }

  turn(at: Point, wheel: Wheel): void {
    const { camera } = this.#host.tab.view;
    camera.value = wheeled(camera.peek(), at, wheel, this.#host.wheel());
    if (this.#gesture && this.#pointer) {
      this.#become(this.#gesture.move(this.#pointer, this.toolContext()));
    } else this.hover(at);
  }

  /** Handles an object that the browser drags over the canvas. */
  bring(dragged: Dragged, pointer: Pointer): void {
    this.#pointer = pointer;
    this.#become(bringing(dragged, pointer, this.toolContext()));
  }

  drop(): void {
    if (this.#gesture) this.#complete(this.#gesture);
  }

  /** Cancels the current gesture; false if there was none. */
  cancel(): boolean {
    this.flush();
    if (!this.#gesture) return false;
    this.#endGesture();
    return true;
  }

  /** Handles a key; false if the canvas does not use it. */
  key(key: KeyPress): boolean {
    if (!isNudge(key)) this.flush();
    return this.#gesture ? this.#gestureKey(this.#gesture, key) : handleKey(this, this.#host, key);
  }

  /** Handles a change of Shift, Ctrl or Alt while the pointer does not move. */
  modifiers(keys: Omit<KeyPress, "key">): void {
    if (!this.#gesture || !this.#pointer || this.#gesture.isSticky) return;
    const { x, y } = this.#pointer;
    this.move({ x, y, ...keys });
  }

  #gestureKey(gesture: Gesture, { key, shift }: KeyPress): boolean {
    if (key === "Escape") return this.cancel();
    if (key === "Enter" && gesture.isSticky) {
      this.#complete(gesture);
      return true;
    }
    const marked = key === " " ? gesture.mark?.(this.toolContext()) : null;
    if (marked) {
      this.#become(marked);
      return true;
    }
    const by = key === "Tab" ? (shift ? -1 : 1) : CYCLE[key];
    if (by === undefined || !gesture.cycle) return false;
    this.#become(gesture.cycle(by, this.toolContext()));
    return true;
  }

  /** Opens the field that renames a state in place, and scrolls the state into view. */
  rename(path: string): void {
    const { session, view } = this.#host.tab;
    const [state, box] = [session.machine.state(path), this.layout().box(path)];
    if (!state || !box) return;
    const same = renamePlan(session.machine, path, state.name);
    const isInner = isRefused(same) && session.machine.isInLibrary(path);
    const why = this.#whyFixed() ?? (isInner ? same.refused : null);
    if (why !== null) {
      this.#host.refuse(why);
      return;
    }
    const { camera } = view;
    const size = this.#host.size();
    const isSeen = intersects(box, visibleBox(camera.peek(), size));
    const isNamed = extentOn(camera.peek(), box) >= DETAIL.name;
    if (!isSeen || !isNamed) camera.value = revealing(box, camera.peek(), size);
    this.#host.rename(path);
  }

  #workingContainerAt(camera: Camera): string {
    return workingContainerOf({ ...this.toolContext(), camera });
  }

  /** Starts a connection at the selected element, by keyboard. */
  connect(): void {
    const [from] = selected(this.#host.tab.view);
    const port = from && firstPort(this.#host.tab.session.machine, from);
    const why =
      this.#whyFixed() ?? (port ? null : "Select a state or port to start the connection from.");
    if (why !== null || !port) {
      this.#host.refuse(why ?? "");
      return;
    }
    this.#become(connecting(port, null, this.toolContext(), true));
  }

  /** Flies until these states, or the root, fill the view. */
  fit(paths: readonly string[]): void {
    const { machine } = this.#host.tab.session;
    const wanted = paths.length === 0 ? [machine.root] : paths;
    const boxes = wanted.flatMap((path) => this.layout().box(path) ?? []);
    const camera = filling(boxes, this.#host.size());
    if (camera) this.#host.fly(camera);
  }

  reveal(element: ElementRef): void {
    const { view } = this.#host.tab;
    const box = this.#shown(element);
    if (!box) return;
    const camera = revealing(box, view.camera.peek(), this.#host.size());
    if (camera !== view.camera.peek()) this.#host.fly(camera);
  }

  /** Flies to the whole proposed machine, or until one of its states is readable. */
  revealGhost(path?: string): void {
    const { view } = this.#host.tab;
    const ghost = view.ghost.peek();
    const box = ghost && ghostBox(this.layout(), ghost, path ?? ghost.machine.root);
    if (!box) return;
    const size = this.#host.size();
    const camera =
      path === undefined ? filling([box], size) : revealing(box, view.camera.peek(), size);
    if (camera) this.#host.fly(camera);
  }

  /** Box of an element on the canvas. A port has the box of its state, a connection the bounds of its route. */
  #shown(element: ElementRef): Box | null {
    const layout = this.layout();
    if (element.kind === "transition" || element.kind === "data_flow") {
      const route = routeOf(layout, { ...element, kind: element.kind });
      return boundsOf((route?.points ?? []).map((at) => ({ ...at, width: 0, height: 0 })));
    }
    return layout.box(element.path) ?? null;
  }

  zoom(factor: number): void {
    const { width, height } = this.#host.size();
    const { camera } = this.#host.tab.view;
    this.#host.fly(zoomedAt(camera.peek(), { x: width / 2, y: height / 2 }, factor));
  }

  /** Container under the pointer, and the position in it; null if the pointer is not over the canvas. */
  pointer(): { readonly path: string; readonly at: Point } | null {
    if (!this.#pointer) return null;
    const { machine, layout, camera } = this.toolContext();
    const path = statesAt(layout, machine, camera, this.#pointer).at(-1);
    if (path === undefined) return null;
    const world = {
      x: this.#pointer.x / camera.scale + camera.x,
      y: this.#pointer.y / camera.scale + camera.y,
    };
    return { path, at: inState(layout, path, world) };
  }

  #become(wanted: Gesture): void {
    const { view } = this.#host.tab;
    const gesture = this.#allowed(wanted);
    const before = this.#gesture;
    this.#gesture = gesture;
    if (gesture.select && before?.select !== gesture.select) select(view, gesture.select);
    if (gesture.camera) view.camera.value = gesture.camera;
    this.overlay.value = gesture.overlay;
    this.cursor.value = gesture.cursor;
  }

  /** Returns the gesture. If editing is not allowed, a gesture that would edit shows the reason instead of a preview. */
  #allowed(gesture: Gesture): Gesture {
    const why = HARMLESS.has(gesture.name) ? null : this.#whyFixed();
    if (why === null) return gesture;
    const { cycle: _, mark: __, ...rest } = gesture;
    return {
      ...rest,
      cursor: "not-allowed",
      overlay: this.#pointer
        ? { ...NO_OVERLAY, message: { at: this.#pointer, text: why, bad: true } }
        : NO_OVERLAY,
      result: () => ({ plan: refused(why) }),
    };
  }

  #endGesture(): void {
    this.#gesture = null;
    this.overlay.value = NO_OVERLAY;
    this.cursor.value = "default";
  }

  #complete(gesture: Gesture): void {
    this.#endGesture();
    this.#take(gesture.result());
  }

  #take(result: GestureResult): void {
    const { view } = this.#host.tab;
    if (result.select) select(view, result.select);
    if (result.toggle) toggle(view, result.toggle);
    if (result.run) this.#host.run(result.run);
    if (result.plan) this.apply(result.plan);
  }

  /** Applies the plan; a refusal is shown at once. */
  apply(plan: Planned): void {
    const made = applyPlan(this.#host.page, this.#host.tab, plan);
    if (typeof made === "string") this.#host.refuse(made);
  }

  #whyFixed(): string | null {
    return whyFixed(this.#host.page, this.#host.tab);
  }
}

const CYCLE: Readonly<Record<string, 1 | -1>> = {
  ArrowRight: 1,
  ArrowDown: 1,
  ArrowLeft: -1,
  ArrowUp: -1,
};
