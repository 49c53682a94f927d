/** A button that is pressed twice: the first press asks, the second is the answer. What comes before the question can have been read
 * is a slip of the hand, and so is what a hurried hand adds behind the answer. */

import { type MouseEvent, useEffect, useRef, useState } from "react";

/** A press sooner than this after the question appeared is none. */
export const SLIP_MS = 400;

/** Time until the question disappears, in ms. */
const AGAIN_MS = 3_000;

/** Since when the question is to be seen, or when the last press of an answer came; times in milliseconds, of one clock. */
export type ConfirmState =
  | { readonly is: "quiet" }
  | { readonly is: "asking"; readonly shown_ms: number }
  | { readonly is: "answered"; readonly pressed_ms: number };

export const QUIET: ConfirmState = { is: "quiet" };

/** State after a press. */
export function pressed(asked: ConfirmState, now_ms: number): ConfirmState {
  if (asked.is === "asking" && now_ms - asked.shown_ms < SLIP_MS) return asked;
  if (asked.is === "asking") return { is: "answered", pressed_ms: now_ms };
  if (asked.is === "answered" && now_ms - asked.pressed_ms < SLIP_MS) {
    return { is: "answered", pressed_ms: now_ms };
  }
  return { is: "asking", shown_ms: now_ms };
}

/** The state of the question, and the handler of the button. */
export function useConfirmPress(onSure: () => void): {
  readonly asks: boolean;
  readonly press: (event: Pick<MouseEvent, "timeStamp">) => void;
} {
  const asked = useRef<ConfirmState>(QUIET);
  const [asks, setAsks] = useState(false);
  useEffect(() => {
    if (!asks) return;
    asked.current = { is: "asking", shown_ms: performance.now() };
    const timer = setTimeout(() => {
      asked.current = QUIET;
      setAsks(false);
    }, AGAIN_MS);
    return () => clearTimeout(timer);
  }, [asks]);
  const press = ({ timeStamp }: Pick<MouseEvent, "timeStamp">) => {
    const before = asked.current.is;
    asked.current = pressed(asked.current, timeStamp);
    setAsks(asked.current.is === "asking");
    if (asked.current.is === "answered" && before === "asking") onSure();
  };
  return { asks, press };
}
