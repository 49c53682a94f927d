/** Options for the comparison of a machine. */

import type { MachineVersions } from "../../model/generated/protocol.ts";
import type { Against } from "../../store/page/comparison.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { wallTime } from "../../store/page/times.ts";

interface AgainstOption {
  readonly value: string;
  readonly title: string;
  readonly against: Against | null;
}

/** Options: no comparison, the file on disk, other tabs, and the versions in git. */
export function againstOptions(
  tabs: readonly OpenTab[],
  own: OpenTab,
  versions: MachineVersions | null,
): readonly AgainstOption[] {
  const others = tabs.filter((tab) => tab !== own);
  return [
    { value: "", title: "Nothing", against: null },
    { value: "saved", title: "Version on disk", against: { kind: "saved" } },
    ...others.map((tab): AgainstOption => {
      const against = { kind: "tab", tab } as const;
      return { value: optionOf(against), title: `Tab: ${nameOf(tab)}`, against };
    }),
    ...(versions?.versions ?? []).map(({ commit, author, at_ms, subject }): AgainstOption => {
      const when = wallTime(at_ms, Date.now());
      const title = `${commit.slice(0, 8)} · ${when} · ${subject} (${author})`;
      return { value: commit, title, against: { kind: "version", commit } };
    }),
  ];
}

export function optionOf(against: Against | null): string {
  switch (against?.kind) {
    case undefined:
      return "";
    case "saved":
      return "saved";
    case "version":
      return against.commit;
    case "tab":
      return `tab ${against.tab.session.id}`;
  }
}

function nameOf({ session }: OpenTab): string {
  return session.machine.state(session.machine.root)?.name ?? session.id;
}
