/** Section of the inspector. Its folding is stored and does not depend on the selection. */

import { signal } from "@preact/signals-core";
import type { ReactNode } from "react";
import { BROWSER_STORE, kept } from "../../store/local_store.ts";
import { Section } from "../../ui/section.tsx";
import { useSignal } from "../../ui/signals.ts";

const KEY = "rafcon.inspector.folds";

/** True for open sections, by title. Sections that the user never folded or opened are missing. */
const folds = signal<Readonly<Record<string, boolean>>>(kept(BROWSER_STORE, KEY) ?? {});

function remember(title: string, open: boolean): void {
  folds.value = { ...folds.peek(), [title]: open };
  BROWSER_STORE.put(KEY, folds.peek());
}

interface FoldProps {
  readonly title: string;
  readonly count?: number | undefined;
  readonly actions?: ReactNode;
  /** True if the section is open until the user folds or opens one of this title. */
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
