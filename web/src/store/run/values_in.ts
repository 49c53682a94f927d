/** All values of a state and of what is inside it, at the shown moment. Values that arrived ahead of their events take precedence. */

import type { LongValue, WatchedValue } from "../../model/generated/protocol.ts";
import { aheadKey } from "../history/ahead.ts";
import type { Watch } from "../history/run.ts";
import { pictureOf } from "./state_status.ts";

export interface ValueIn extends Pick<WatchedValue, "kind" | "path" | "name"> {
  readonly value: unknown;
  /** Metadata of a value that is too long to arrive ahead of its event; the value is then null. */
  readonly long: LongValue | null;
  /** Time of the value in the run if it arrived ahead of its event; otherwise null. */
  readonly aheadAt_ns: number | null;
}

/** True if a path is that of the state, or inside it. */
export function isIn(path: string, state: string): boolean {
  return path === state || path.startsWith(`${state}/`);
}

/** Values in the order of their paths. Reads signals. */
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
