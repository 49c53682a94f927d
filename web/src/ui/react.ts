/** Replaces `react` and `react-dom` by Preact, a sixth of their size, and bridges its differences.
 * Knows no component. */

import { options, type VNode } from "preact";
import compat, { createElement, Fragment, createPortal as portal } from "preact/compat";
import { useEffect, useRef, useState } from "preact/hooks";

// @ts-expect-error: its types are one object, and nobody reads them here: those of React hold
export * from "preact/compat";
export { act } from "preact/test-utils";

/** By then immediate changes have been painted. */
const LATER_MS = 20;

/** A deferred value: immediate changes are painted before this one. A value that changes without a pause is still updated, every few
 * frames. */
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

/** After mounting, because browsers apply `autofocus` only once for each page. */
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

/** A controlled select or checkbox shows its property until the property changes, whatever the user pressed. A checkbox reports during
 * the press, before other changes of the press are drawn. */
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
