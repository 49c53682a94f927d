/** Lists that stay at their end while they grow, and distinguish their own scrolling from the user's. */

import { type RefObject, useEffect, useMemo } from "react";

interface Scrolled {
  /** The list has scrolled to its present position by itself. */
  readonly note: () => void;
  /** True if the user has scrolled away from the end. */
  readonly isSomebody: () => boolean;
}

/** Keeps a list at its end, also after it was hidden or resized, and distinguishes its own scrolling from the user's. */
export function useScrolled(
  place: RefObject<HTMLElement | null>,
  follow: boolean,
  many: number,
): Scrolled {
  const scrolled = useMemo(() => {
    let own = 0;
    const note = () => {
      own = place.current?.scrollTop ?? 0;
    };
    const isSomebody = () => {
      const top = place.current?.scrollTop ?? 0;
      const isElsewhere = Math.abs(top - own) >= 1;
      own = top;
      return isElsewhere;
    };
    return { note, isSomebody };
  }, [place]);
  useEffect(() => {
    const list = place.current;
    if (!follow || !list || many === 0) return;
    const toEnd = () => {
      list.scrollTop = list.scrollHeight;
      scrolled.note();
    };
    toEnd();
    const resized = new ResizeObserver(toEnd);
    resized.observe(list);
    return () => resized.disconnect();
  }, [place, follow, many, scrolled]);
  return scrolled;
}

/** Closer to the end than this, in CSS pixels, is at it. */
const NEAR_PX = 24;

/** True if a list is scrolled to its end. */
export function isAtEnd({ scrollTop, scrollHeight, clientHeight }: HTMLElement): boolean {
  return scrollHeight - scrollTop - clientHeight < NEAR_PX;
}
