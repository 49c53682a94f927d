/** Automatic layouts in progress: how far one is, and how it is cancelled. Another one cancels it as well. */

import { type ReadonlySignal, signal } from "@preact/signals-core";
import type { Machine } from "../model/machine.ts";
import type { Level, Progress } from "../plan/arrange.ts";
import type { OpenTab } from "../store/page/page.ts";
import { abandonLayout, layOut } from "./layouter.ts";

export interface LayoutWork {
  readonly tab: OpenTab;
  /** States in the containers that are laid out. */
  readonly states: number;
  readonly levelsDone: number;
  readonly levels: number;
}

const work = signal<LayoutWork | null>(null);

/** The layout in progress. */
export const layoutWork: ReadonlySignal<LayoutWork | null> = work;

export function cancelLayout(): void {
  if (work.peek() === null) return;
  work.value = null;
  abandonLayout();
}

/** Computes the layout of a container, or of all containers in it as well; null if it is cancelled. */
export async function layoutOf(
  tab: OpenTab,
  machine: Machine,
  container: string,
  deep: boolean,
): Promise<ReadonlyMap<string, Level> | null> {
  cancelLayout();
  let mine: LayoutWork = { tab, states: 0, levelsDone: 0, levels: 0 };
  const isCancelled = () => work.peek() !== mine;
  const progress: Progress = {
    isCancelled,
    report: (now) => {
      if (isCancelled()) return;
      mine = { tab, ...now };
      work.value = mine;
    },
  };
  work.value = mine;
  const { arrange } = await import("../plan/arrange.ts");
  try {
    const levels = await arrange(machine, container, deep, layOut, progress);
    return isCancelled() ? null : levels;
  } catch (error) {
    if (isCancelled()) return null;
    throw error;
  } finally {
    if (!isCancelled()) work.value = null;
  }
}
