/** Components in a document, for tests: made, pressed and typed into as by a user. */

import { act, type ReactElement } from "react";
import { createRoot, type Root } from "react-dom/client";

Object.assign(globalThis, { IS_REACT_ACT_ENVIRONMENT: true });

/** How tall everything is: a document without a screen has no sizes, and what is out of sight is not made. */
const HEIGHT_PX = 240;

let root: Root | null = null;

/** Puts the component into an empty document. */
export function mount(element: ReactElement): HTMLElement {
  unmount();
  for (const side of ["offsetHeight", "offsetWidth", "clientHeight"] as const) {
    Object.defineProperty(HTMLElement.prototype, side, { configurable: true, value: HEIGHT_PX });
  }
  const place = document.createElement("div");
  document.body.replaceChildren(place);
  root = createRoot(place);
  draw(element);
  return place;
}

/** Draws it again with other properties. */
export function draw(element: ReactElement): void {
  act(() => root?.render(element));
}

export function unmount(): void {
  act(() => root?.unmount());
  root = null;
}

export function press(target: Element | null, key: string, more: KeyboardEventInit = {}): void {
  act(() => {
    target?.dispatchEvent(
      new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true, ...more }),
    );
  });
}

export function click(target: Element | null): void {
  act(() => {
    target?.dispatchEvent(new MouseEvent("click", { bubbles: true, cancelable: true }));
  });
}

/** The focus goes elsewhere. */
export function leave(target: Element | null): void {
  act(() => {
    target?.dispatchEvent(new FocusEvent("focusout", { bubbles: true }));
  });
}

/** Types over what stands in a field. */
export async function type(target: Element | null, text: string): Promise<void> {
  await act(async () => {
    if (!(target instanceof HTMLInputElement)) throw new Error("this is no field");
    const value = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value");
    value?.set?.call(target, text);
    target.dispatchEvent(new Event("input", { bubbles: true }));
  });
}

/** What was begun comes to its end. */
export async function settled(): Promise<void> {
  await act(async () => {
    await Promise.resolve();
  });
}

export function byRole(place: ParentNode, role: string): HTMLElement[] {
  return [...place.querySelectorAll<HTMLElement>(`[role=${role}]`)];
}
