/** What the page and its libraries import as `react` and `react-dom`: Preact, a sixth of its size, and here what it does otherwise.
 * Knows no component. */

import { options, type VNode } from "preact";
import compat, { createElement, Fragment, createPortal as portal } from "preact/compat";
import { useEffect, useRef, useState } from "preact/hooks";

// @ts-expect-error: its types are one object, and nobody reads them here: those of React hold
export * from "preact/compat";
export { act } from "preact/test-utils";

/** By then what changed at once has been painted. */
const LATER_MS = 20;

/** The value as it was: what changes at once is shown before what may come a picture later. A value that changes without a pause is
 * shown all the same, every few pictures. */
export function useDeferredValue<T>(value: T): T {
  const [shown, setShown] = useState({ value });
  const newest = useRef(value);
  newest.current = value;
  const timer = useRef<ReturnType<typeof setTimeout> | undefined>(undefined);
  useEffect(() => {
    if (timer.current !== undefined || Object.is(shown.value, value)) return;
    timer.current = setTimeout(() => {
      timer.current = undefined;
      setShown({ value: newest.current });
    }, LATER_MS);
  }, [shown, value]);
  useEffect(() => () => clearTimeout(timer.current), []);
  return shown.value;
}

/** With a key: one of several portals that goes must not take the places of the others. */
export function createPortal(children: VNode, container: Element, key?: string) {
  return createElement(Fragment, { key }, portal(children, container));
}

type ChoiceListener = (event: Event) => void;

interface MadeElement {
  readonly type: unknown;
  readonly props: Record<string, unknown> & {
    readonly autoFocus?: boolean;
    onChange?: ChoiceListener;
    onClick?: ChoiceListener;
  };
  ref?: ((element: HTMLElement | null) => void) | { current: HTMLElement | null } | null;
}

// Effects come before the next key does: what they put into an editor must not be older than what is typed there.
options.requestAnimationFrame = queueMicrotask;

const madeBefore = options.vnode;
options.vnode = (vnode) => {
  madeBefore?.(vnode);
  const made = vnode as unknown as MadeElement;
  if (typeof made.type !== "string") return;
  if (made.props.autoFocus) focusFirst(made);
  if (made.props.onChange) keepGiven(made, made.props.onChange);
};

const focused = new WeakSet<HTMLElement>();

/** Once it is there: a browser heeds `autofocus` only once in the life of a page. */
function focusFirst(made: MadeElement): void {
  const { ref } = made;
  made.ref = (element) => {
    if (typeof ref === "function") ref(element);
    else if (ref) ref.current = element;
    if (element === null || focused.has(element)) return;
    focused.add(element);
    element.focus();
  };
}

/** A choice shows what it is given until it is given another value, whatever was pressed. A box is asked while it is pressed:
 * what else the press changes is drawn before it would tell. */
function keepGiven({ type, props }: MadeElement, changed: ChoiceListener): void {
  const name = type === "select" ? "value" : "checked";
  if (!(name in props)) return;
  const { onClick } = props;
  const chosen: ChoiceListener = (event) => {
    const element = event.currentTarget;
    changed(event);
    if (element) Object.assign(element, { [name]: props[name] });
  };
  if (type === "select") {
    props.onChange = chosen;
    return;
  }
  delete props.onChange;
  props.onClick = (event) => {
    onClick?.(event);
    chosen(event);
  };
}

// biome-ignore lint/style/noDefaultExport: some libraries import it as a whole
export default { ...compat, createPortal, useDeferredValue };
