/** A part of the page that is loaded when it is first shown, so that a slow link loads visible parts first. */

import { type ReadonlySignal, signal } from "@preact/signals-core";
import { type FunctionComponent, type ReactElement, useEffect } from "react";
import { Empty } from "./empty.tsx";
import { useSignal } from "./signals.ts";

type Loaded<Props> =
  | { readonly is: "away" | "coming" | "failed" }
  | { readonly is: "there"; readonly component: FunctionComponent<Props> };

interface Part<Props> {
  readonly loaded: ReadonlySignal<Loaded<Props>>;
  readonly load: () => Promise<void>;
}

/** A component that loads what it shows. */
export interface OnDemand<Props> {
  (props: Props): ReactElement | null;
  /** Loads it before it is shown. Never fails: what did not load is loaded when it is shown. */
  readonly preload: () => Promise<void>;
}

/** A component that is loaded when it is first shown, or earlier. `frame` wraps the message of a failed load. */
export function onDemand<Props extends object>(
  load: () => Promise<FunctionComponent<Props>>,
  frame: (words: ReactElement, props: Props) => ReactElement = (words) => words,
): OnDemand<Props> {
  const part = partOf(load);
  const shown = (props: Props) => <Shown part={part} props={props} frame={frame} />;
  return Object.assign(shown, { preload: part.load });
}

function partOf<Props>(load: () => Promise<FunctionComponent<Props>>): Part<Props> {
  const loaded = signal<Loaded<Props>>({ is: "away" });
  const fetch = async () => {
    loaded.value = { is: "coming" };
    try {
      loaded.value = { is: "there", component: await load() };
    } catch {
      loaded.value = { is: "failed" };
    }
  };
  let coming: Promise<void> | null = null;
  return {
    loaded,
    load: () => {
      if (coming === null || loaded.peek().is === "failed") coming = fetch();
      return coming;
    },
  };
}

interface OnDemandProps<Props> {
  readonly part: Part<Props>;
  readonly props: Props;
  readonly frame: (words: ReactElement, props: Props) => ReactElement;
}

function Shown<Props extends object>({ part, props, frame }: OnDemandProps<Props>) {
  const loaded = useSignal(part.loaded);
  useEffect(() => void part.load(), [part]);
  if (loaded.is === "there") return <loaded.component {...props} />;
  if (loaded.is !== "failed") return null;
  return frame(
    <Empty
      title="This part of the page did not load"
      text="Check the connection, then try again. If the server was updated, reload the page."
      action={{ title: "Try again", onClick: () => void part.load() }}
    />,
    props,
  );
}

/** Loads parts one after the other, each while the browser has nothing else to do. */
export async function preloadAll(parts: readonly OnDemand<never>[]): Promise<void> {
  for (const part of parts) {
    await new Promise<void>((idle) => {
      if ("requestIdleCallback" in window) window.requestIdleCallback(() => idle());
      else setTimeout(idle, 50);
    });
    await part.preload();
  }
}
