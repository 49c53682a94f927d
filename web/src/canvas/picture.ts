/** Canvas element with the picture of a machine. Watches everything that the picture depends on, and repaints at most once per
 * frame and only after changes. */

import { effect, type ReadonlySignal, signal } from "@preact/signals-core";
import type { ElementKey } from "../model/element.ts";
import type { MachineProblem, Severity } from "../model/generated/protocol.ts";
import type { Size } from "../model/geometry.ts";
import { perOwner } from "../model/per_owner.ts";
import { onTheme, scaledContext } from "../store/canvas_element.ts";
import type { MachineSession } from "../store/document/machine_session.ts";
import type { OpenTab } from "../store/page/page.ts";
import { ghostLayers } from "./ghost.ts";
import { type LayoutTree, layoutTreeOf } from "./layout/layout_tree.ts";
import type { Overlay } from "./overlay.ts";
import { type Colours, coloursOf } from "./paint/colours.ts";
import { measureWith } from "./paint/measure.ts";
import { paint } from "./paint/paint.ts";
import { IdleRouter } from "./routing/idle_router.ts";
import { type DifferenceKind, type Onlooker, PLAIN, type SceneInput } from "./scene/input.ts";
import type { DrawList } from "./scene/list.ts";
import { scene } from "./scene/scene.ts";

/** Additional data for the picture, from other parts of the page. */
export interface RunOverlay {
  readonly differences?: ReadonlyMap<ElementKey, DifferenceKind>;
  readonly hits?: ReadonlySet<ElementKey>;
  readonly runs?: SceneInput["runs"];
  readonly errors?: SceneInput["errors"];
  readonly taken?: SceneInput["taken"];
  readonly sinceSnapshot_ms?: SceneInput["sinceSnapshot_ms"];
  readonly visits?: SceneInput["visits"];
  readonly values?: SceneInput["values"];
  readonly heat?: SceneInput["heat"];
  readonly breakpoints?: SceneInput["breakpoints"];
}

interface PictureOptions {
  readonly tab: OpenTab;
  /** Preview of the current gesture. Reads a signal, so that the picture follows it. */
  readonly overlay: () => Overlay;
  readonly runOverlay?: () => RunOverlay;
}

export interface CanvasPicture {
  readonly canvas: HTMLCanvasElement;
  /** Size in CSS pixels. */
  readonly size: () => Size;
  readonly layout: () => LayoutTree;
  /** Activity of states in the run. Reads a signal. */
  readonly runs: () => SceneInput["runs"];
  /** States with breakpoints. Reads a signal. */
  readonly breakpoints: () => SceneInput["breakpoints"];
  /** Recently taken transitions. Reads a signal. */
  readonly taken: () => SceneInput["taken"];
  /** Marks of the last painted frame. */
  readonly list: () => DrawList;
  /** Requests a repaint with the next frame. */
  readonly redraw: () => void;
  readonly colours: () => Colours;
  /** Counter that changes whenever the colours change. */
  readonly theme: ReadonlySignal<number>;
  /** Error of the last attempt to draw, after which the picture is outdated; null if it succeeded. */
  readonly fault: ReadonlySignal<string | null>;
  /** Calls the listener after each painted frame. Returns a function that removes it. */
  readonly onFrame: (listener: () => void) => () => void;
  readonly dispose: () => void;
}

/** Target duration of a frame with routing, and lower and upper limit of the routing in it, in ms. */
const FRAME_MS = 11;
const LEAST_ROUTING_MS = 2;
const MOST_ROUTING_MS = 6;

function withGhost(list: DrawList, ghost: Pick<DrawList, "layers" | "unfinished">): DrawList {
  const layers = [...list.layers, ...ghost.layers];
  return { ...list, layers, unfinished: list.unfinished || ghost.unfinished };
}

const EMPTY: DrawList = { layers: [], wanted: [], soon: [], unfinished: false };

/** Adds a picture to an element, and keeps it up to date. */
export function pictureIn(place: HTMLElement, options: PictureOptions): CanvasPicture {
  const { session, view } = options.tab;
  const canvas = canvasIn(place);
  const context = canvas.getContext("2d", { alpha: false, desynchronized: false });
  const theme = signal(0);
  const fault = signal<string | null>(null);
  let colours: Colours = coloursOf(place);
  let measure = context && measureWith(context);
  let size = sizeOf(place);
  let list = EMPTY;
  let frame = 0;
  // Duration of the last frame without routing, in ms.
  let lasted = 0;
  const listeners = new Set<() => void>();
  const idleRouter = new IdleRouter();

  const layout = () => layoutOf(options);
  const draw = () => {
    if (!context || !measure || size.width === 0 || size.height === 0) return;
    const from = performance.now();
    const routing = routingTime(FRAME_MS - lasted);
    const input = inputOf(options, layout(), size, measure, routing.mayGoOn);
    const ghost = view.ghost.peek();
    list = ghost ? withGhost(scene(input), ghostLayers(input, ghost)) : scene(input);
    scaledContext(canvas, size);
    paintOver(context, size, list, colours);
    lasted = measureFrame(from) - routing.used();
    for (const path of list.wanted) libraries.load(path);
    if (list.unfinished) redraw();
    else idleRouter.look(list.soon);
    for (const listener of listeners) listener();
  };
  const drawOrTell = () => {
    frame = 0;
    fault.value = faultOf(draw);
  };
  const redraw = () => {
    if (frame === 0) frame = requestAnimationFrame(drawOrTell);
  };
  const libraries = loader(session, () => redraw());
  const stop = watch(place, options, {
    changed: redraw,
    themed: () => {
      colours = coloursOf(place);
      theme.value++;
      redraw();
    },
    sized: () => {
      size = sizeOf(place);
      redraw();
    },
    lettered: () => {
      measure = context && measureWith(context);
      redraw();
    },
  });

  return {
    canvas,
    size: () => size,
    layout,
    ...overlayReaders(options),
    list: () => list,
    redraw,
    colours: () => colours,
    theme,
    fault,
    onFrame: (listener) => {
      listeners.add(listener);
      return () => listeners.delete(listener);
    },
    dispose: () => {
      cancelAnimationFrame(frame);
      idleRouter.stop();
      libraries.stop();
      stop();
      canvas.remove();
    },
  };
}

function paintOver(
  context: CanvasRenderingContext2D,
  size: Size,
  list: DrawList,
  colours: Colours,
) {
  context.fillStyle = colours["ground"] ?? "";
  context.fillRect(0, 0, size.width, size.height);
  paint(context, list, colours);
}

/** Error of a function; null if there is none. Uncaught, it would leave an outdated picture without a message. */
function faultOf(act: () => void): string | null {
  try {
    act();
    return null;
  } catch (error) {
    console.error(error);
    return error instanceof Error ? error.message : String(error);
  }
}

function sizeOf({ clientWidth, clientHeight }: HTMLElement): Size {
  return { width: clientWidth, height: clientHeight };
}

function canvasIn(place: HTMLElement): HTMLCanvasElement {
  const canvas = document.createElement("canvas");
  canvas.style.cssText = "display:block;width:100%;height:100%";
  place.append(canvas);
  return canvas;
}

function layoutOf({ tab: { session, view }, overlay }: PictureOptions): LayoutTree {
  const shown = { modes: view.modes.peek(), contents: view.contents.peek() };
  return layoutTreeOf(session.machine, shown, overlay().provisional);
}

/** Reports the duration of a frame to the browser's performance tools, and returns it in ms. */
function measureFrame(start: number): number {
  const end = performance.now();
  performance.clearMeasures("rafcon:frame");
  performance.measure("rafcon:frame", { start, end });
  return end - start;
}

function overlayReaders({ runOverlay }: PictureOptions) {
  return {
    runs: () => runOverlay?.().runs ?? PLAIN.runs,
    breakpoints: () => runOverlay?.().breakpoints ?? PLAIN.breakpoints,
    taken: () => runOverlay?.().taken ?? PLAIN.taken,
  };
}

interface Loader {
  readonly load: (path: string) => void;
  readonly stop: () => void;
}

/** Loads the content of libraries, each once. A change that may affect all libraries allows another load. */
function loader(session: MachineSession, came: () => void): Loader {
  let asked = new Set<string>();
  const stop = session.onChange((touched) => {
    if (touched === null) asked = new Set();
  });
  const load = (path: string) => {
    if (asked.has(path)) return;
    asked.add(path);
    session.loadLibrary(path).then(came, () => undefined);
  };
  return { load, stop };
}

interface PictureListener {
  readonly changed: () => void;
  readonly themed: () => void;
  readonly sized: () => void;
  readonly lettered: () => void;
}

/** Calls back after changes that affect the picture. Returns a function that stops it. */
function watch(place: HTMLElement, options: PictureOptions, tell: PictureListener): () => void {
  const stopFollowing = effect(() => {
    follow(options);
    tell.changed();
  });
  const stopHearing = options.tab.session.onChange(tell.changed);
  const stopTheme = onTheme(tell.themed, place.parentElement);
  const resized = new ResizeObserver(tell.sized);
  resized.observe(place);
  document.fonts?.addEventListener("loadingdone", tell.lettered);
  return () => {
    stopFollowing();
    stopHearing();
    stopTheme();
    resized.disconnect();
    document.fonts?.removeEventListener("loadingdone", tell.lettered);
  };
}

/** Reads all signals that the picture depends on. */
function follow({ tab, overlay, runOverlay }: PictureOptions): void {
  const { session, view } = tab;
  session.version.value;
  session.people.value;
  session.problems.value;
  view.camera.value;
  view.selection.value;
  view.hovered.value;
  view.modes.value;
  view.contents.value;
  view.marks.value;
  view.ghost.value;
  overlay();
  runOverlay?.();
}

function inputOf(
  { tab, overlay, runOverlay }: PictureOptions,
  layout: LayoutTree,
  size: Size,
  measure: SceneInput["measure"],
  mayRoute: () => boolean,
): SceneInput {
  const { session, view } = tab;
  return {
    ...PLAIN,
    layout,
    camera: view.camera.peek(),
    view: size,
    modes: view.modes.peek(),
    selection: view.selection.peek(),
    hovered: view.hovered.peek(),
    overlay: overlay(),
    people: onlookers(session.people.peek()),
    problems: worst(session.problems.peek()),
    differences: view.marks.peek() ?? PLAIN.differences,
    measure,
    mayRoute,
    ...runOverlay?.(),
  };
}

function onlookers(people: OpenTab["session"]["people"]["value"]): readonly Onlooker[] {
  return people.map(({ user, connection, selection }) => ({
    name: user,
    colour: connection,
    selection,
  }));
}

const RANK: Readonly<Record<Severity, number>> = { note: 0, warning: 1, error: 2 };

/** Most severe problem of each state. */
const worst = perOwner((problems: readonly MachineProblem[]): ReadonlyMap<string, Severity> => {
  const found = new Map<string, Severity>();
  for (const { path, severity } of problems) {
    const before = found.get(path);
    if (before === undefined || RANK[severity] > RANK[before]) found.set(path, severity);
  }
  return found;
});

interface RoutingTime {
  /** True if this frame has time left. The first call always returns true. */
  readonly mayGoOn: () => boolean;
  readonly used: () => number;
}

/** Time for routing, counted from its first use. `left` is the remaining time of the frame. */
function routingTime(left: number): RoutingTime {
  const most = Math.min(MOST_ROUTING_MS, Math.max(LEAST_ROUTING_MS, left));
  let [begun, last] = [0, 0];
  return {
    mayGoOn: () => {
      last = performance.now();
      if (begun === 0) begun = last;
      return last <= begun + most;
    },
    used: () => Math.min(most, last - begun),
  };
}
