/** Which rows of a long list are in sight. They have one height, so that this is arithmetic, however many there are. */

import { type RefObject, useLayoutEffect, useMemo, useState } from "react";

/** Rows that are made beyond both edges, so that a quick turn of the wheel shows no gap. */
const BEYOND = 8;

/** Visible range of a list: the first rendered row, and the first row after them. */
interface Span {
  readonly first: number;
  readonly end: number;
}

export interface RowsInSight {
  /** The numbers of the rows that are made. */
  readonly indices: readonly number[];
  /** Total height of all rows, in CSS pixels. */
  readonly height: number;
  /** Scrolls as little as it takes to bring a row into sight, or puts it into the middle. */
  readonly show: (index: number, where?: "nearest" | "centre") => void;
}

/** Visible rows of the list that scrolls in `place`, below a fixed head. */
export function useRowsInSight(
  place: RefObject<HTMLElement | null>,
  count: number,
  rowPx: number,
  headPx = 0,
): RowsInSight {
  const [span, setSpan] = useState<Span>({ first: 0, end: 0 });
  useLayoutEffect(() => {
    const list = place.current;
    if (!list) return;
    const measure = () => {
      const next = spanOf(list, rowPx);
      setSpan((now) => (now.first === next.first && now.end === next.end ? now : next));
    };
    measure();
    const resized = new ResizeObserver(measure);
    resized.observe(list);
    list.addEventListener("scroll", measure, { passive: true });
    return () => {
      resized.disconnect();
      list.removeEventListener("scroll", measure);
    };
  }, [place, rowPx]);
  const show = useMemo(
    () =>
      (index: number, where: "nearest" | "centre" = "nearest") => {
        const list = place.current;
        if (list) list.scrollTop = scrolledTo(list, index * rowPx, rowPx, headPx, where);
      },
    [place, rowPx, headPx],
  );
  // The list may have become shorter since it was measured: its last rows are what it will be scrolled to.
  const end = Math.min(count, span.end);
  const first = Math.max(0, Math.min(span.first, end - (span.end - span.first)));
  const indices = Array.from({ length: end - first }, (_, at) => first + at);
  return { indices, height: count * rowPx, show };
}

function spanOf({ scrollTop, clientHeight }: HTMLElement, rowPx: number): Span {
  return {
    first: Math.max(0, Math.floor(scrollTop / rowPx) - BEYOND),
    end: clientHeight === 0 ? 0 : Math.ceil((scrollTop + clientHeight) / rowPx) + BEYOND,
  };
}

function scrolledTo(
  { scrollTop, clientHeight }: HTMLElement,
  top: number,
  rowPx: number,
  headPx: number,
  where: "nearest" | "centre",
): number {
  const room = clientHeight - headPx;
  if (where === "centre") return Math.max(0, top - (room - rowPx) / 2);
  return Math.max(Math.min(scrollTop, top), top + rowPx - room);
}
