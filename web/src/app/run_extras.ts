/** What the canvas shows of the run on its tab: marks, values and heat, each made anew only when what it shows is different. */

import { computed, effect, type ReadonlySignal } from "@preact/signals-core";
import type { Extras } from "../canvas/picture.ts";
import { HEAT_LEVELS, type ValueChip } from "../canvas/scene/input.ts";
import { shortValue } from "../model/short_value.ts";
import { type CountUntil, countsUntil } from "../store/history/counts_until.ts";
import type { Watch } from "../store/history/run.ts";
import type { OpenTab, Page } from "../store/page/page.ts";
import { breakpointsOf } from "../store/run/breakpoints.ts";
import { heatOf } from "../store/run/heat.ts";
import { runMarks } from "../store/run/marks.ts";
import { portValues } from "../store/run/port_values.ts";
import { sinceSnapshot } from "../store/run/since_snapshot.ts";

/** So many letters of a value are shown when it is pointed at. */
const FULL = 320;
const CHIP = 18;
const NO_VALUES: ReadonlyMap<string, ValueChip> = new Map();

interface RunExtras {
  /** A signal's reader. */
  readonly read: () => Extras;
  readonly stop: () => void;
}

export function runExtras(page: Page, tab: OpenTab): RunExtras {
  const values = valuesOf(tab);
  const heat = computed(() => heatNow(tab)?.levels ?? null);
  const points = computed(() => pointsInShort(tab));
  const breakpoints = computed(() => breakpointMarks(points.value));
  const extras = computed((): Extras => {
    const watch = tab.run.value;
    if (!watch) return { breakpoints: breakpoints.value };
    const { states, lines, visits } = runMarks(watch, tab.session);
    return {
      runs: states,
      taken: lines,
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
  return { read: () => extras.value, stop };
}

/** The same text as long as nothing about breakpoints is different. */
function pointsInShort(tab: OpenTab): string {
  return breakpointsOf(tab)
    .map(({ path, enabled }) => `${enabled ? "on" : "off"} ${path}`)
    .join("\n");
}

/** States with breakpoints: whether any of theirs is on. */
function breakpointMarks(points: string): ReadonlyMap<string, "on" | "off"> {
  const marks = new Map<string, "on" | "off">();
  for (const line of points === "" ? [] : points.split("\n")) {
    const at = line.indexOf(" ");
    const path = line.slice(at + 1);
    if (marks.get(path) !== "on") marks.set(path, line.slice(0, at) === "on" ? "on" : "off");
  }
  return marks;
}

/** The heat that the canvas shows; null while it shows none. A signal's reader. */
export function heatNow({ run, view }: OpenTab) {
  const [watch, mode] = [run.value, view.heat.value];
  if (!watch || mode === "off") return null;
  return heatOf(countsShown(watch), mode, HEAT_LEVELS);
}

/** What states did until the moment that is shown; while live, all that they did. */
function countsShown({ journal, journalVersion, playhead }: Watch): Iterable<CountUntil> {
  const until = playhead.value;
  if (until !== null) return countsUntil(journal, journal.indexOf(until + 1)).all();
  journalVersion.value;
  return journal.counts.all();
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
