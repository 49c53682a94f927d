/** Comparison of a tab's machine with another one: updated while the machine changes, and marked on the canvas. */

import { batch, type ReadonlySignal, signal } from "@preact/signals-core";
import { type Difference, differences, marksOf } from "../../model/difference.ts";
import type { Document, MachineDocument } from "../../model/generated/protocol.ts";
import type { Machine } from "../../model/machine.ts";
import { perOwner } from "../../model/per_owner.ts";
import { machineOf } from "../../model/plain_machine.ts";
import type { OpenTab } from "./page.ts";
import { RefusalError, type Server } from "./server.ts";

export type Against =
  /** Version on disk. */
  | { readonly kind: "saved" }
  /** A commit. */
  | { readonly kind: "version"; readonly commit: string }
  /** Current machine of another tab. */
  | { readonly kind: "tab"; readonly tab: OpenTab };

export interface MachineComparison {
  readonly against: ReadonlySignal<Against | null>;
  /** Machine on the other side; null before it is loaded. */
  readonly other: ReadonlySignal<Machine | null>;
  readonly found: ReadonlySignal<readonly Difference[]>;
  /** Reason why the other side could not be loaded. */
  readonly refusal: ReadonlySignal<string | null>;
  /** Selects the other side; null ends the comparison. */
  readonly choose: (against: Against | null) => Promise<void>;
  /** Reloads the other side. */
  readonly refresh: () => Promise<void>;
}

/** Delay from the last change to the comparison. */
const SETTLED_MS = 150;

/** The comparison of a tab. A tab has only one. */
export const comparisonOf = perOwner(newComparison);

function newComparison(tab: OpenTab, server: Server): MachineComparison {
  const against = signal<Against | null>(null);
  const other = signal<Machine | null>(null);
  const found = signal<readonly Difference[]>([]);
  const refusal = signal<string | null>(null);
  let timer: ReturnType<typeof setTimeout> | undefined;
  let stops: readonly (() => void)[] = [];

  const compare = () => {
    const { machine } = tab.session;
    const all = other.value ? differences(other.value, machine) : [];
    batch(() => {
      found.value = all;
      tab.view.marks.value = other.value && marksOf(all, machine);
    });
  };
  const soon = () => {
    clearTimeout(timer);
    timer = setTimeout(compare, SETTLED_MS);
  };
  const refresh = async () => {
    const wanted = against.peek();
    const answer = wanted && (await sideOf(tab, server, wanted));
    if (against.peek() !== wanted) return;
    batch(() => {
      refusal.value = typeof answer === "string" ? answer : null;
      other.value = typeof answer === "string" ? null : answer;
      compare();
    });
  };
  const choose = async (next: Against | null) => {
    for (const stop of stops) stop();
    clearTimeout(timer);
    batch(() => {
      against.value = next;
      other.value = null;
      refusal.value = null;
      compare();
    });
    stops = next ? [tab.session.onChange(soon), follow(tab, next, soon, refresh)] : [];
    await refresh();
  };
  return { against, other, found, refusal, choose, refresh };
}

/** Listens for changes of the other side, until the returned function is called. */
function follow(
  tab: OpenTab,
  against: Against,
  changed: () => void,
  refresh: () => Promise<void>,
): () => void {
  if (against.kind === "tab") return against.tab.session.onChange(changed);
  if (against.kind === "version") return () => {};
  const summary = () => tab.session.status.peek()?.summary;
  let known = `${summary()?.saved_revision} ${summary()?.disk}`;
  return tab.session.status.subscribe(() => {
    const now = `${summary()?.saved_revision} ${summary()?.disk}`;
    if (now === known) return;
    known = now;
    void refresh();
  });
}

/** Machine on the other side, or the reason why it could not be loaded. */
async function sideOf(tab: OpenTab, server: Server, against: Against): Promise<Machine | string> {
  if (against.kind === "tab") return against.tab.session.machine;
  const path = `/machines/${encodeURIComponent(tab.session.id)}`;
  const from = against.kind === "saved" ? "saved" : `versions/${against.commit}`;
  try {
    const answer = await server.request<Document | MachineDocument>("GET", `${path}/${from}`);
    return machineOf("document" in answer ? answer.document : answer);
  } catch (error) {
    if (error instanceof RefusalError) return error.message;
    throw error;
  }
}
