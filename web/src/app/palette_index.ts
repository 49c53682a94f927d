/** Search results of the palette: commands, states of the current machine, machines and libraries, the best first. Pure. */

import fuzzysort from "fuzzysort";
import type { CommandChoice, UserCommand } from "../commands/command.ts";

type PaletteHit =
  | { readonly kind: "command"; readonly command: UserCommand; readonly choice?: CommandChoice }
  | { readonly kind: "state"; readonly path: string }
  | { readonly kind: "machine"; readonly project: string; readonly path: string }
  | { readonly kind: "library"; readonly path: string; readonly name: string };

export interface PaletteItem {
  readonly found: PaletteHit;
  readonly title: string;
  /** Its path or description. */
  readonly detail: string;
  readonly keys?: string | undefined;
  readonly disabled?: boolean;
}

/** Prefixes that limit a search to one kind. */
const PREFIXES: Readonly<Record<string, PaletteHit["kind"]>> = {
  ">": "command",
  "@": "state",
  "#": "library",
};

const SHOWN_MAX = 60;

/** Finds states by a text, the best first, up to a limit. There are too many to create items for all. */
export type FindStates = (
  text: string,
  count: number,
) => readonly { readonly item: PaletteItem; readonly score: number }[];

/** The items and states that fit, the best first; without a text those that come first anyway. */
export function searched(
  items: readonly PaletteItem[],
  query: string,
  findStates: FindStates,
): readonly PaletteItem[] {
  const only = PREFIXES[query[0] ?? ""];
  const wanted = (only ? query.slice(1) : query).trim();
  const among = only ? items.filter(({ found }) => found.kind === only) : items;
  const states = only && only !== "state" ? [] : findStates(wanted, SHOWN_MAX);
  if (wanted === "") {
    const offered = among.filter(({ disabled }) => !disabled);
    return [...offered, ...states.map(({ item }) => item)].slice(0, SHOWN_MAX);
  }
  const scored = fuzzysort.go(wanted, among, {
    keys: ["title", "detail"],
    limit: SHOWN_MAX,
    threshold: 0.3,
    scoreFn: ([title, detail]) => {
      const best = Math.max(title?.score ?? 0, (detail?.score ?? 0) * 0.6);
      return best;
    },
  });
  const all = [...[...scored].map(({ obj, score }) => ({ item: obj, score })), ...states];
  all.sort((one, other) => other.score - one.score);
  return all.slice(0, SHOWN_MAX).map(({ item }) => item);
}
