/** Scroll positions of a panel and its content, stored while another panel is in front, because browsers forget them for what is out of
 * the document. */

import { type RefObject, useEffect } from "react";

interface Offset {
  readonly top: number;
  readonly left: number;
}

export class KeptScroll {
  readonly #offsets = new Map<HTMLElement, Offset>();

  /** Remembers where something is scrolled to. */
  note(scrolled: EventTarget | null): void {
    if (!(scrolled instanceof HTMLElement) || !scrolled.isConnected) return;
    this.#offsets.set(scrolled, { top: scrolled.scrollTop, left: scrolled.scrollLeft });
  }

  /** Scrolls all to where they were; what stays at its end goes there by itself. */
  restore(root: Element): void {
    for (const [element, { top, left }] of this.#offsets) {
      if (!root.contains(element)) this.#offsets.delete(element);
      else if (element.dataset["follow"] !== "true") {
        element.scrollTop = top;
        element.scrollLeft = left;
      }
    }
  }
}

/** Keeps it for everything in a place. */
export function useKeptScroll(place: RefObject<HTMLElement | null>): void {
  useEffect(() => {
    const root = place.current;
    if (!root) return;
    const kept = new KeptScroll();
    const note = ({ target }: Event) => kept.note(target);
    let wasThere = true;
    const resized = new ResizeObserver(() => {
      const isThere = root.clientHeight > 0;
      if (isThere && !wasThere) kept.restore(root);
      wasThere = isThere;
    });
    root.addEventListener("scroll", note, { capture: true, passive: true });
    resized.observe(root);
    return () => {
      root.removeEventListener("scroll", note, { capture: true });
      resized.disconnect();
    };
  }, [place]);
}
