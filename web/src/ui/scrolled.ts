/** Lists that stay at their end while they grow, and tell their own scrolling from somebody's. */

import { type RefObject, useEffect, useMemo } from "react";

interface Scrolled {
  /** Where it is now the list has scrolled to by itself. */
  readonly note: () => void;
  /** Whether it is elsewhere, by somebody's hand. */
  readonly isSomebody: () => boolean;
}

/** Keeps a list of so many rows at its end, also when it comes back into the page or gets another size, and tells its own scrolling from others'. */
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

/** Whether a list is scrolled to its end. */
export function isAtEnd({ scrollTop, scrollHeight, clientHeight }: HTMLElement): boolean {
  return scrollHeight - scrollTop - clientHeight < NEAR_PX;
}
