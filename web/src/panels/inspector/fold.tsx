/** A section of the inspector: which ones are folded is remembered, whatever is selected. */

import { signal } from "@preact/signals-core";
import type { ReactNode } from "react";
import { BROWSER_STORE, kept } from "../../store/local_store.ts";
import { Section } from "../../ui/section.tsx";
import { useSignal } from "../../ui/signals.ts";

const KEY = "rafcon.inspector.folds";

/** Titles of sections by whether they are open; those that nobody touched are missing. */
const folds = signal<Readonly<Record<string, boolean>>>(kept(BROWSER_STORE, KEY) ?? {});

function remember(title: string, open: boolean): void {
  folds.value = { ...folds.peek(), [title]: open };
  BROWSER_STORE.put(KEY, folds.peek());
}

interface FoldProps {
  readonly title: string;
  readonly count?: number | undefined;
  readonly actions?: ReactNode;
  /** Whether it is open as long as nobody has folded or opened one like it. */
  readonly openAtFirst?: boolean | undefined;
  readonly children: ReactNode;
}

export function Fold({ title, openAtFirst = true, children, ...rest }: FoldProps) {
  const open = useSignal(folds)[title] ?? openAtFirst;
  return (
    <Section title={title} open={open} onToggle={(now) => remember(title, now)} {...rest}>
      {children}
    </Section>
  );
}
