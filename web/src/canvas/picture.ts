/** The canvas element with the picture of a machine: watches all that the picture depends on, and paints it anew, once a frame at
 * most and never for nothing. */

import { effect, type ReadonlySignal, signal } from "@preact/signals-core";
import type { ElementKey } from "../model/element.ts";
import type { MachineProblem, Severity } from "../model/generated/protocol.ts";
import type { Size } from "../model/geometry.ts";
import { perOwner } from "../model/per_owner.ts";
import { onTheme, scaledContext } from "../store/canvas_element.ts";
import type { MachineSession } from "../store/document/machine_session.ts";
import type { OpenTab } from "../store/page/page.ts";
import { ghostLayers } from "./ghost.ts";
import { IdleRouter } from "./idle_router.ts";
import { type LayoutTree, layoutTreeOf } from "./layout_tree.ts";
import type { Overlay } from "./overlay.ts";
import { type Colours, coloursOf } from "./paint/colours.ts";
import { measureWith } from "./paint/measure.ts";
import { paint } from "./paint/paint.ts";
import { type DifferenceKind, type Onlooker, PLAIN, type SceneInput } from "./scene/input.ts";
import type { DrawList } from "./scene/list.ts";
import { scene } from "./scene/scene.ts";

/** What is shown beside the machine itself, by those who know it. */
export interface Extras {
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
  /** What gestures show now; a signal's reader, so that the picture follows it. */
  readonly overlay: () => Overlay;
  readonly extras?: () => Extras;
}

export interface CanvasPicture {
  readonly canvas: HTMLCanvasElement;
  /** In CSS pixels. */
  readonly size: () => Size;
  readonly layout: () => LayoutTree;
  /** What states do in the run; a signal's reader. */
  readonly runs: () => SceneInput["runs"];
  /** States with breakpoints; a signal's reader. */
  readonly breakpoints: () => SceneInput["breakpoints"];
  /** Transitions that were taken lately; a signal's reader. */
  readonly taken: () => SceneInput["taken"];
  /** What is painted now. */
  readonly list: () => DrawList;
  /** Paints anew with the next frame. */
  readonly redraw: () => void;
  readonly colours: () => Colours;
  /** Another number whenever the colours are others. */
  readonly theme: ReadonlySignal<number>;
  /** Why it could not be drawn the last time: what is to be seen is old. Null if it could. */
  readonly fault: ReadonlySignal<string | null>;
  /** Told after each painted frame. Returns the way to stop. */
  readonly onFrame: (listener: () => void) => () => void;
  readonly dispose: () => void;
}

/** So many ms a frame may take with finding the ways of lines, and so many of them are for that at least and at most. */
const FRAME_MS = 11;
const LEAST_ROUTING_MS = 2;
const MOST_ROUTING_MS = 6;

function withGhost(list: DrawList, ghost: Pick<DrawList, "layers" | "unfinished">): DrawList {
  const layers = [...list.layers, ...ghost.layers];
  return { ...list, layers, unfinished: list.unfinished || ghost.unfinished };
}

const EMPTY: DrawList = { layers: [], wanted: [], soon: [], unfinished: false };

/** Puts a picture into an element, and keeps it true. */
export function pictureIn(place: HTMLElement, options: PictureOptions): CanvasPicture {
  const { session, view } = options.tab;
  const canvas = document.createElement("canvas");
  canvas.style.cssText = "display:block;width:100%;height:100%";
  place.append(canvas);
  const context = canvas.getContext("2d", { alpha: false, desynchronized: false });
  const theme = signal(0);
  const fault = signal<string | null>(null);
  let colours: Colours = coloursOf(place);
  let measure = context && measureWith(context);
  let size: Size = { width: place.clientWidth, height: place.clientHeight };
  let list = EMPTY;
  let frame = 0;
  /** How many ms the last frame took without finding ways. */
  let lasted = 0;
  const listeners = new Set<() => void>();
  const idleRouter = new IdleRouter();

  const layout = () => {
    const shown = { modes: view.modes.peek(), contents: view.contents.peek() };
    return layoutTreeOf(session.machine, shown, options.overlay().provisional);
  };
  const draw = () => {
    if (!context || !measure || size.width === 0 || size.height === 0) return;
    const from = performance.now();
    const routing = routingTime(FRAME_MS - lasted);
    const input = inputOf(options, layout(), size, measure, routing.mayGoOn);
    list = scene(input);
    const ghost = view.ghost.peek();
    if (ghost) list = withGhost(list, ghostLayers(input, ghost));
    scaledContext(canvas, size);
    context.fillStyle = colours["ground"] ?? "";
    context.fillRect(0, 0, size.width, size.height);
    paint(context, list, colours);
    const until = performance.now();
    lasted = until - from - routing.used();
    performance.clearMeasures("rafcon:frame");
    performance.measure("rafcon:frame", { start: from, end: until });
    for (const path of list.wanted) libraries.load(path);
    if (list.unfinished) redraw();
    else idleRouter.look(list.soon);
    for (const listener of listeners) listener();
  };
  /** Draws; what is thrown here nobody else would catch, and the last picture would stay as if it were true. */
  const drawOrTell = () => {
    frame = 0;
    try {
      draw();
      fault.value = null;
    } catch (error) {
      console.error(error);
      fault.value = error instanceof Error ? error.message : String(error);
    }
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
      size = { width: place.clientWidth, height: place.clientHeight };
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
    runs: () => options.extras?.().runs ?? PLAIN.runs,
    breakpoints: () => options.extras?.().breakpoints ?? PLAIN.breakpoints,
    taken: () => options.extras?.().taken ?? PLAIN.taken,
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

interface Loader {
  readonly load: (path: string) => void;
  readonly stop: () => void;
}

/** Gets the content of libraries, each once; those that may have changed once more. */
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

/** Tells what the picture has to follow; returns the way to stop. */
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
function follow({ tab, overlay, extras }: PictureOptions): void {
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
  extras?.();
}

function inputOf(
  { tab, overlay, extras }: PictureOptions,
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
    ...extras?.(),
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

/** The worst problem of each state. */
const worst = perOwner((problems: readonly MachineProblem[]): ReadonlyMap<string, Severity> => {
  const found = new Map<string, Severity>();
  for (const { path, severity } of problems) {
    const before = found.get(path);
    if (before === undefined || RANK[severity] > RANK[before]) found.set(path, severity);
  }
  return found;
});

interface RoutingTime {
  /** Whether there is time left in this frame. The first is always granted. */
  readonly mayGoOn: () => boolean;
  readonly used: () => number;
}

/** Time from when it is asked for first, as much as the rest of the frame leaves. */
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
