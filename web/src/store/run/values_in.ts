/** All values of a state and of what is in it, at the moment that is shown: those that came ahead of their events count first. */

import type { LongValue, WatchedValue } from "../../model/generated/protocol.ts";
import { aheadKey } from "../history/ahead.ts";
import type { Watch } from "../history/run.ts";
import { pictureOf } from "./state_status.ts";

export interface ValueIn extends Pick<WatchedValue, "kind" | "path" | "name"> {
  readonly value: unknown;
  /** Instead of the value, what is known of one that is too long to come ahead of its event. */
  readonly long: LongValue | null;
  /** When it came into being, if it came ahead of its event: a time of the run. */
  readonly aheadAt_ns: number | null;
}

/** Whether a path is that of the state, or of something in it. */
export function isIn(path: string, state: string): boolean {
  return path === state || path.startsWith(`${state}/`);
}

/** Reads signals. In the order of their paths. */
export function valuesIn(watch: Watch, state: string): readonly ValueIn[] {
  const found = new Map<string, ValueIn>();
  const put = (value: ValueIn) => {
    if (isIn(value.path, state)) found.set(aheadKey(value), value);
  };
  for (const each of inPicture(watch)) put(each);
  const { journal } = watch;
  watch.journalVersion.value;
  for (const ahead of watch.playhead.value === null ? watch.ahead.value.values.values() : []) {
    if (ahead.sequence < journal.next || ahead.kind === "global") continue;
    const { kind, path, name, value, large, t_ns: aheadAt_ns } = ahead;
    put({ kind, path, name, value, long: value === null ? large : null, aheadAt_ns });
  }
  return [...found.values()].sort((one, other) => (one.path < other.path ? -1 : 1));
}

function* inPicture(watch: Watch): Generator<ValueIn> {
  const rest = { long: null, aheadAt_ns: null };
  for (const { path, inputs, scoped, ended } of pictureOf(watch)?.active ?? []) {
    for (const [name, value] of Object.entries(inputs ?? {}))
      yield { kind: "input", path, name, value, ...rest };
    for (const [name, value] of Object.entries(scoped))
      yield { kind: "scoped_variable", path, name, value, ...rest };
    for (const end of ended) {
      for (const [name, value] of Object.entries(end.outputs ?? {}))
        yield { kind: "output", path: end.path, name, value, ...rest };
    }
  }
}
