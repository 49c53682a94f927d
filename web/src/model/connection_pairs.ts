/** Pairs the connections of two versions of a container: by id, otherwise by their ends. */

import type { DataFlowDocument, TransitionDocument } from "./generated/protocol.ts";
import { isSame } from "./json.ts";

type ConnectionDocument = TransitionDocument | DataFlowDocument;

interface LinePair {
  readonly old: ConnectionDocument | null;
  readonly now: ConnectionDocument | null;
}

/** Connections that were added, removed or redirected. `idNow` returns the current id for an old one. */
export function pairConnections(
  old: readonly ConnectionDocument[],
  now: readonly ConnectionDocument[],
  idNow: (id: string) => string,
): readonly LinePair[] {
  const ends = (line: ConnectionDocument) => endsOf(line, idNow);
  const same = (one: ConnectionDocument, other: ConnectionDocument) =>
    isSame(
      ends(one),
      endsOf(other, (id) => id),
    );
  const earlier = new Map(old.map((line) => [line.id, line]));
  const changed: LinePair[] = [];
  const added: ConnectionDocument[] = [];
  for (const line of now) {
    const before = earlier.get(line.id);
    if (before) earlier.delete(line.id);
    if (!before) added.push(line);
    else if (!same(before, line)) changed.push({ old: before, now: line });
  }
  const gone = [...earlier.values()];
  for (const line of added) {
    const at = gone.findIndex((before) => same(before, line));
    if (at >= 0) gone.splice(at, 1);
    else changed.push({ old: null, now: line });
  }
  return [...changed, ...gone.map((line) => ({ old: line, now: null }))];
}

/** Both ends of a connection, by current ids. */
function endsOf(line: ConnectionDocument, idNow: (id: string) => string): readonly unknown[] {
  const id = (state: string | null | undefined) => (state == null ? null : idNow(state));
  if ("from_port" in line) {
    return [id(line.from_state), line.from_port, id(line.to_state), line.to_port];
  }
  const { from_state, from_outcome, to_state, to_outcome } = line;
  return [id(from_state), from_outcome ?? null, id(to_state), to_outcome ?? null];
}
