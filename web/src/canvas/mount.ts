/** Adds the canvas to the document: the picture, the interaction controller, and the listeners for pointer, wheel, keys and
 * drags. `dispose` removes all of it. */

import { effect } from "@preact/signals-core";
import { type ElementRef, keyOf } from "../model/element.ts";
import type { Point } from "../model/geometry.ts";
import { isRefused } from "../plan/plan.ts";
import { rename } from "../plan/states.ts";
import type { CommandCall } from "../store/page/command_arguments.ts";
import { dragged } from "../store/page/dragged.ts";
import type { OpenTab, Page } from "../store/page/page.ts";
import { select, selected, selectedStates } from "../store/page/view.ts";
import { panned, screenBox, visibleBox } from "./camera/camera.ts";
import { firstLook } from "./camera/first_look.ts";
import { Flight, WINDOW_FRAMES } from "./camera/flight.ts";
import { followRun } from "./camera/follow.ts";
import { minimapIn } from "./camera/minimap.ts";
import type { CanvasControl } from "./control.ts";
import { nameArea } from "./hit/hit.ts";
import { extentOn } from "./hit/shown.ts";
import { InteractionController } from "./interaction.ts";
import { listen } from "./listen.ts";
import { type CanvasPicture, pictureIn, type RunOverlay } from "./picture.ts";
import { pulsesOver } from "./pulses.ts";
import { urgentWords } from "./reader/describe.ts";
import { ReaderTree, treeLines } from "./reader/reader.ts";
import { renameField } from "./rename_field.ts";

interface MountOptions {
  readonly tab: OpenTab;
  readonly page: Page;
  /** Runs a command by its id. */
  readonly run: (call: CommandCall) => void;
  /** Opens the menu of elements; the point is in CSS pixels of the window. */
  readonly menuAt: (at: Point, elements: readonly ElementRef[]) => void;
  readonly runOverlay?: () => RunOverlay;
}

export interface Mounted {
  readonly control: CanvasControl;
  readonly picture: CanvasPicture;
  readonly dispose: () => void;
}

let mounted = 0;

/** Fills an element with the canvas of a machine. */
export function mountCanvas(place: HTMLElement, options: MountOptions): Mounted {
  const { tab, page } = options;
  const root = application(place);
  const flight = new Flight(tab.view.camera, WINDOW_FRAMES);
  let closeField = () => {};
  const controller: InteractionController = new InteractionController({
    page,
    tab,
    size: () => picture.size(),
    wheel: () => page.settings.peek().wheel,
    fly: (to) => flight.to(to),
    heading: () => flight.goal,
    run: options.run,
    refuse: (text) => page.tell({ level: "warning", text: tab.session.named(text) }),
    rename: (path) => {
      closeField();
      closeField = openField(root, place, controller, tab, path);
    },
  });
  const picture = pictureIn(root, {
    tab,
    overlay: () => controller.overlay.value,
    ...(options.runOverlay ? { runOverlay: options.runOverlay } : {}),
  });
  picture.canvas.setAttribute("aria-hidden", "true");
  const pulses = pulsesOver(root, picture, tab.run);
  const minimap = minimapIn(place, tab, picture, () => root.focus({ preventScroll: true }));
  // Must come before `followRun`: the first camera position does not count as a movement by the user.
  const stopLooking = firstLook(root, tab, controller);
  const stopFollowing = followRun(tab, page, picture, flight);
  const reader = new ReaderTree(root, `rafcon-canvas-${++mounted}`);
  const stopReading = keepReading(reader, controller, tab, picture);
  const stopCursor = effect(() => {
    root.style.cursor = controller.cursor.value;
  });
  const openMenu = (at: Point) => {
    const elements = selected(tab.view);
    const { left, top } = root.getBoundingClientRect();
    options.menuAt({ x: at.x + left, y: at.y + top }, elements);
  };
  const stopListening = listen(root, {
    controller,
    reader,
    dragged: () => dragged.peek(),
    interrupt: () => flight.stop(),
    choose: (element) => select(tab.view, [element]),
    menu: (at) => {
      if (at) choosesForMenu(controller, tab, at);
      openMenu(at ?? placeOfSelection(controller, tab, picture));
    },
  });
  return {
    picture,
    control: controlOf(root, controller, tab, picture, flight, () =>
      openMenu(placeOfSelection(controller, tab, picture)),
    ),
    dispose: () => {
      controller.flush();
      controller.cancel();
      flight.stop();
      closeField();
      stopListening();
      stopCursor();
      stopLooking();
      stopReading();
      stopFollowing();
      minimap.dispose();
      pulses.dispose();
      picture.dispose();
      root.remove();
    },
  };
}

function application(place: HTMLElement): HTMLElement {
  const root = document.createElement("div");
  root.setAttribute("role", "application");
  root.setAttribute("aria-label", "State machine");
  root.tabIndex = 0;
  root.className = "canvas";
  root.style.cssText =
    "position:absolute;inset:0;overflow:hidden;touch-action:none;user-select:none;-webkit-user-select:none";
  if (getComputedStyle(place).position === "static") place.style.position = "relative";
  place.append(root);
  return root;
}

function controlOf(
  root: HTMLElement,
  controller: InteractionController,
  tab: OpenTab,
  picture: CanvasPicture,
  flight: Flight,
  openMenu: () => void,
): CanvasControl {
  const { camera } = tab.view;
  return {
    fit: (paths) => controller.fit(paths),
    reveal: (element) => controller.reveal(element),
    revealGhost: (path) => controller.revealGhost(path),
    zoom: (factor) => controller.zoom(factor),
    pan: (by) => {
      flight.stop();
      camera.value = panned(camera.peek(), by);
    },
    visible: () => visibleBox(camera.peek(), picture.size()),
    pointer: () => controller.pointer(),
    beginConnection: () => {
      root.focus({ preventScroll: true });
      controller.connect();
    },
    rename: (path) => controller.rename(path),
    cancel: () => controller.cancel(),
    openMenu,
    flush: () => controller.flush(),
    focus: () => root.focus({ preventScroll: true }),
    workingContainer: controller.workingContainer,
  };
}

/** Selects the element under the pointer for the menu, unless it is selected already. */
function choosesForMenu(controller: InteractionController, { view }: OpenTab, at: Point): void {
  controller.cancel();
  const element = controller.at(at)?.element;
  if (!element) select(view, []);
  else if (!view.selection.peek().has(keyOf(element))) select(view, [element]);
}

function placeOfSelection(
  controller: InteractionController,
  { view }: OpenTab,
  picture: CanvasPicture,
): Point {
  const element = selected(view).at(-1);
  const box = element && controller.layout().box(element.path);
  const { width, height } = picture.size();
  if (!box) return { x: width / 2, y: height / 2 };
  const on = screenBox(view.camera.peek(), box);
  return {
    x: Math.min(Math.max(on.x + on.width / 2, 0), width),
    y: Math.min(Math.max(on.y + on.height / 2, 0), height),
  };
}

/** Opens the field over the name of a state. It closes when the camera moves. */
function openField(
  root: HTMLElement,
  place: HTMLElement,
  controller: InteractionController,
  { session, view }: OpenTab,
  path: string,
): () => void {
  const [state, box] = [session.machine.state(path), controller.layout().box(path)];
  if (!state || !box) return () => {};
  const camera = view.camera.peek();
  const isOpen = controller.layout().children(path).length > 0;
  const field = renameField({
    place,
    box: nameArea(screenBox(camera, box), extentOn(camera, box), isOpen),
    name: state.name,
    take: (name) => {
      const plan = rename(session.machine, path, name);
      if (isRefused(plan)) return plan.refused;
      controller.apply(plan);
      return null;
    },
    done: () => {
      stop();
      root.focus({ preventScroll: true });
    },
  });
  const stopCamera = effect(() => {
    if (view.camera.value !== camera) field.close();
  });
  const stopWatching = effect(() => {
    session.version.value;
    const now = session.machine.state(path)?.name;
    if (now === undefined || now === state.name) return;
    field.warn(
      `Someone renamed it to “${now}”. Press Enter to keep your name, Escape to take theirs.`,
    );
  });
  const stop = () => {
    stopCamera();
    stopWatching();
  };
  return field.close;
}

/** Interval of updates of active states and breakpoints for screen readers, in ms. */
const READ_RUN_MS = 1_000;

/** Updates the hidden tree after changes of the canvas, at most once per frame. */
function keepReading(
  reader: ReaderTree,
  controller: InteractionController,
  { session, view }: OpenTab,
  picture: CanvasPicture,
): () => void {
  let frame = 0;
  let rest = 0;
  let before = { path: "", words: "" };
  const signsOf = (path: string) => ({
    run: picture.runs().get(path),
    breakpoint: picture.breakpoints().get(path),
  });
  const tell = () => {
    const [path = "", ...more] = selectedStates(view);
    const words = more.length > 0 ? "" : urgentWords(session.machine, path, signsOf(path));
    if (path === before.path && words !== before.words) reader.say(words);
    before = { path, words };
  };
  const show = () => {
    frame = 0;
    const [layout, workingContainer] = [controller.layout(), controller.workingContainer.peek()];
    reader.show(treeLines(session.machine, layout, workingContainer, selected(view), signsOf));
    tell();
  };
  const showRun = () => {
    rest = 0;
    show();
  };
  const stop = effect(() => {
    session.version.value;
    view.selection.value;
    controller.workingContainer.value;
    if (frame === 0) frame = requestAnimationFrame(show);
  });
  const stopRunning = effect(() => {
    picture.runs();
    if (rest === 0) rest = window.setTimeout(showRun, READ_RUN_MS);
  });
  const stopSaying = effect(() => {
    reader.say(controller.overlay.value.message?.text ?? "");
  });
  return () => {
    cancelAnimationFrame(frame);
    window.clearTimeout(rest);
    stop();
    stopRunning();
    stopSaying();
  };
}
