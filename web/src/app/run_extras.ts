/** What the canvas shows of the run on its tab: marks, values and heat, each made anew only when what it shows is different. */

import { computed, effect, type ReadonlySignal } from "@preact/signals-core";
import type { Extras } from "../canvas/picture.ts";
import { HEAT_LEVELS, type ValueChip } from "../canvas/scene/input.ts";
import { shortValue } from "../model/short_value.ts";
import { heatOf } from "../store/heat.ts";
import { runMarks } from "../store/marks.ts";
import type { OpenTab } from "../store/page.ts";
import { portValues } from "../store/port_values.ts";

/** So many letters of a value are shown when it is pointed at. */
const FULL = 320;
const CHIP = 18;
const NO_VALUES: ReadonlyMap<string, ValueChip> = new Map();

export interface RunExtras {
  /** A signal's reader. */
  readonly read: () => Extras;
  readonly stop: () => void;
}

export function runExtras(tab: OpenTab): RunExtras {
  const values = valuesOf(tab);
  const heat = computed(() => heatNow(tab)?.levels ?? null);
  const extras = computed((): Extras => {
    const watch = tab.run.value;
    if (!watch) return {};
    const { states, lines, visits } = runMarks(watch, tab.room);
    return { runs: states, taken: lines, visits, values: values.value, heat: heat.value };
  });
  const stop = effect(() => {
    const watch = tab.run.value;
    return watch && tab.view.modes.value.values ? watch.wantValues() : undefined;
  });
  return { read: () => extras.value, stop };
}

/** The heat that the canvas shows; null while it shows none. A signal's reader. */
export function heatNow({ run, view }: OpenTab) {
  const [watch, mode] = [run.value, view.heat.value];
  if (!watch || mode === "off") return null;
  watch.grown.value;
  return heatOf(watch.journal, mode, HEAT_LEVELS);
}

function valuesOf({ run, view, room }: OpenTab): ReadonlySignal<ReadonlyMap<string, ValueChip>> {
  return computed(() => {
    const watch = run.value;
    if (!watch || !view.modes.value.values) return NO_VALUES;
    const picture = watch.seen.value?.picture;
    room.version.value;
    if (!picture) return NO_VALUES;
    return new Map(
      [...portValues(picture, room.machine)].map(([key, value]) => [
        key,
        { short: shortValue(value, CHIP), full: shortValue(value, FULL) },
      ]),
    );
  });
}
