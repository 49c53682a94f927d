/** Marks, values and heat of the run on the canvas, each recomputed only after changes. */

import { computed, effect, type ReadonlySignal } from "@preact/signals-core";
import type { RunOverlay } from "../canvas/picture.ts";
import { HEAT_LEVELS, type ValueChip } from "../canvas/scene/input.ts";
import { shortValue } from "../model/short_value.ts";
import { type CountUntil, countsUntil } from "../store/history/counts_until.ts";
import type { Watch } from "../store/history/run.ts";
import type { OpenTab, Page } from "../store/page/page.ts";
import { breakpointsOf } from "../store/run/breakpoints.ts";
import { sinceSnapshot } from "../store/run/data_end.ts";
import { heatOf } from "../store/run/heat.ts";
import { runMarks } from "../store/run/marks.ts";
import { portValues } from "../store/run/port_values.ts";
import { computedWith, isSameList } from "../ui/signals.ts";

/** Length of a value's tooltip, in characters. */
const FULL = 320;
const CHIP = 18;
const NO_VALUES: ReadonlyMap<string, ValueChip> = new Map();

interface RunOverlayReader {
  /** A signal's reader. */
  readonly read: () => RunOverlay;
  readonly stop: () => void;
}

export function runOverlay(page: Page, tab: OpenTab): RunOverlayReader {
  const values = valuesOf(tab);
  const heat = computed(() => heatNow(tab)?.levels ?? null);
  const breakpoints = computedWith(() => breakpointMarks(tab), isSameMarks);
  const overlay = computed((): RunOverlay => {
    const watch = tab.run.value;
    if (!watch) return { breakpoints: breakpoints.value };
    const { states, lines, errors, visits } = runMarks(watch, tab.session);
    return {
      runs: states,
      taken: lines,
      errors,
      sinceSnapshot_ms: sinceSnapshot(page, watch),
      visits,
      values: values.value,
      heat: heat.value,
      breakpoints: breakpoints.value,
    };
  });
  const stop = effect(() => {
    const watch = tab.run.value;
    return watch && tab.view.modes.value.values ? watch.wantValues() : undefined;
  });
  return { read: () => overlay.value, stop };
}

/** States with breakpoints: whether any of theirs is on. */
function breakpointMarks(tab: OpenTab): ReadonlyMap<string, "on" | "off"> {
  const marks = new Map<string, "on" | "off">();
  for (const { path, enabled } of breakpointsOf(tab)) {
    if (marks.get(path) !== "on") marks.set(path, enabled ? "on" : "off");
  }
  return marks;
}

function isSameMarks<T>(one: ReadonlyMap<string, T>, other: ReadonlyMap<string, T>): boolean {
  return isSameList([...one].flat(), [...other].flat());
}

/** The heat that the canvas shows; null while it shows none. A signal's reader. */
export function heatNow({ run, view }: OpenTab) {
  const [watch, mode] = [run.value, view.heat.value];
  if (!watch || mode === "off") return null;
  return heatOf(countsShown(watch), mode, HEAT_LEVELS);
}

/** Counts and times of the states up to the shown moment, or of all events while live. */
function countsShown(watch: Watch): Iterable<CountUntil> {
  const until = watch.playhead.value;
  watch.journalVersion.value;
  // The part around the moment, or what had been before it, may be on its way.
  if (!watch.window.hasCounts) return [];
  if (until === null) return watch.journal.counts.all();
  if (!watch.window.covers(until)) return [];
  return countsUntil(watch.window, watch.window.indexOf(until + 1)).all();
}

function valuesOf({ run, view, session }: OpenTab): ReadonlySignal<ReadonlyMap<string, ValueChip>> {
  return computed(() => {
    const watch = run.value;
    if (!watch || !view.modes.value.values) return NO_VALUES;
    const picture = watch.playheadSnapshot.value?.picture;
    session.version.value;
    if (!picture) return NO_VALUES;
    return new Map(
      [...portValues(picture, session.machine)].map(([key, value]) => [
        key,
        { short: shortValue(value, CHIP), full: shortValue(value, FULL) },
      ]),
    );
  });
}
