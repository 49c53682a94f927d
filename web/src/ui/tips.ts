/** Tooltips and context menus for keyboard and touch, which browsers offer only to mice. */

import "./tips.css";

/** Long enough not to flicker while somebody walks past. */
const SHOWN_AFTER_MS = 500;
const RESTS_MS = 600;
const RESTS_WITHIN_PX = 10;
const GAP_PX = 4;

/** Begins in a window of the page; the answer ends it. */
export function listenForTips(page: Document): () => void {
  const stops = [showTitles(page), askForMenus(page)];
  return () => {
    for (const stop of stops) stop();
  };
}

/** Shows the title of the focused element, and of a disabled button after a tap. Screen readers announce titles themselves. */
function showTitles(page: Document): () => void {
  let tip: HTMLElement | null = null;
  let timer: ReturnType<typeof setTimeout> | undefined;
  const hide = () => {
    clearTimeout(timer);
    tip?.remove();
    tip = null;
  };
  const show = (of: HTMLElement) => {
    hide();
    if (!of.isConnected) return;
    tip = page.createElement("div");
    tip.className = "tip";
    tip.setAttribute("aria-hidden", "true");
    tip.textContent = of.title;
    // Over dialogs, and in them: what lies behind one is not seen.
    (of.closest("dialog") ?? page.body).append(tip);
    place(tip, of.getBoundingClientRect(), page.documentElement);
  };
  const come = ({ target }: Event) => {
    hide();
    const of = titled(target);
    if (of?.matches(":focus-visible")) timer = setTimeout(() => show(of), SHOWN_AFTER_MS);
  };
  const tap = (event: PointerEvent) => {
    hide();
    const of = titled(event.target);
    if (event.pointerType === "touch" && of?.getAttribute("aria-disabled") === "true") show(of);
  };
  const heard = {
    focusin: come,
    focusout: hide,
    keydown: hide,
    pointerdown: hide,
    pointerup: tap,
    scroll: hide,
  };
  return listen(page, heard);
}

/** Below it where there is room, above it else. */
function place(tip: HTMLElement, of: DOMRect, view: HTMLElement): void {
  const { width, height } = tip.getBoundingClientRect();
  const left = Math.max(GAP_PX, Math.min(of.left, view.clientWidth - width - GAP_PX));
  const isBelow = of.bottom + GAP_PX + height <= view.clientHeight;
  const top = isBelow ? of.bottom + GAP_PX : of.top - GAP_PX - height;
  Object.assign(tip.style, { left: `${left}px`, top: `${Math.max(GAP_PX, top)}px` });
}

function titled(target: EventTarget | null): HTMLElement | null {
  return target instanceof Element ? target.closest<HTMLElement>("[title]:not([title=''])") : null;
}

/** Some browsers send no event for a long press. The canvas handles its own. */
function askForMenus(page: Document): () => void {
  let from: { readonly x: number; readonly y: number } | null = null;
  let timer: ReturnType<typeof setTimeout> | undefined;
  const end = () => {
    clearTimeout(timer);
    from = null;
  };
  const ask = ({ target, clientX, clientY }: PointerEvent) => {
    end();
    const asked = { bubbles: true, cancelable: true, clientX, clientY };
    const isMenu = !target?.dispatchEvent(new MouseEvent("contextmenu", asked));
    // This release is no click, which would close the menu.
    if (isMenu) page.addEventListener("touchend", (event) => event.preventDefault(), ONCE);
  };
  const begin = (event: PointerEvent) => {
    end();
    const { target, pointerType, isPrimary } = event;
    if (pointerType !== "touch" || !isPrimary || !(target instanceof Element)) return;
    if (target.localName === "canvas") return;
    from = { x: event.clientX, y: event.clientY };
    timer = setTimeout(() => ask(event), RESTS_MS);
  };
  const move = ({ clientX, clientY }: PointerEvent) => {
    if (from && Math.hypot(clientX - from.x, clientY - from.y) > RESTS_WITHIN_PX) end();
  };
  const heard = {
    pointerdown: begin,
    pointermove: move,
    pointerup: end,
    pointercancel: end,
    contextmenu: end,
  };
  return listen(page, heard);
}

const ONCE = { once: true, passive: false, capture: true };

function listen(
  page: Document,
  heard: Readonly<Record<string, (event: PointerEvent) => void>>,
): () => void {
  const all = Object.entries(heard) as [string, EventListener][];
  for (const [name, listener] of all) page.addEventListener(name, listener, true);
  return () => {
    for (const [name, listener] of all) page.removeEventListener(name, listener, true);
  };
}
