/** The canvas and mission control in elements of their own, which move from the first panes into the dock with all that the user has
 * entered there. */

import { signal } from "@preact/signals-core";
import { type FunctionComponent, useEffect, useRef } from "react";
import { createPortal } from "react-dom";
import { Mission } from "../panels/mission/mission.tsx";
import { useSignal } from "../ui/signals.ts";
import { CanvasArea } from "./canvas_area.tsx";
import { PanelGuard } from "./panel_guard.tsx";
import { useSession } from "./session_context.tsx";

const HOSTED = {
  canvas: { name: "The canvas", content: CanvasArea },
  mission: { name: "Mission", content: Mission },
} as const satisfies Readonly<
  Record<string, { readonly name: string; readonly content: FunctionComponent }>
>;

export type HostedId = keyof typeof HOSTED;

/** Time in which content without a place waits for the next one, in ms. */
const BETWEEN_MS = 1_000;

/** Element of a hosted part, and whether it has a place. */
class Host {
  readonly element: HTMLElement | null = null;
  readonly isPlaced = signal(false);

  constructor() {
    if (typeof document === "undefined") return;
    this.element = document.createElement("div");
    this.element.className = "hosted";
  }

  /** Moves the element to a place; the returned function takes it away, unless it has moved on. */
  moveTo(place: HTMLElement): () => void {
    const { element } = this;
    if (!element) return () => {};
    const { activeElement } = element.ownerDocument;
    const focused = activeElement instanceof HTMLElement && element.contains(activeElement);
    place.append(element);
    if (focused) activeElement.focus({ preventScroll: true });
    this.isPlaced.value = true;
    return () => {
      if (element.parentElement !== place) return;
      element.remove();
      setTimeout(() => {
        if (!element.isConnected) this.isPlaced.value = false;
      }, BETWEEN_MS);
    };
  }
}

const HOSTS: Readonly<Record<HostedId, Host>> = { canvas: new Host(), mission: new Host() };

/** Place of a hosted part. The last one that is shown has it. */
export function HostedPlace({ id }: { readonly id: HostedId }) {
  const place = useRef<HTMLDivElement>(null);
  useEffect(() => (place.current ? HOSTS[id].moveTo(place.current) : undefined), [id]);
  return <div ref={place} className="hosted-place" />;
}

/** Content of the hosted parts that have a place. */
export function HostedParts() {
  return (Object.keys(HOSTED) as HostedId[]).map((id) => <HostedPart key={id} id={id} />);
}

function HostedPart({ id }: { readonly id: HostedId }) {
  const { page } = useSession();
  const { element, isPlaced } = HOSTS[id];
  const isShown = useSignal(isPlaced);
  if (!element || !isShown) return null;
  const { name, content: Content } = HOSTED[id];
  return createPortal(
    <PanelGuard name={name} page={page}>
      <Content />
    </PanelGuard>,
    element,
  );
}
