/** Uses of a library in open machines and in files. A click opens the use. */

import { X } from "lucide-react";
import { useEffect, useMemo, useState } from "react";
import type { LibraryName, LibraryUsage, LibraryUsages } from "../../model/generated/protocol.ts";
import { IconButton } from "../../ui/button.tsx";
import { Empty } from "../../ui/empty.tsx";
import { Section } from "../../ui/section.tsx";
import { Tree } from "../../ui/tree.tsx";
import { type PanelHost, useHost } from "../context.tsx";
import { goTo } from "../go_to.ts";

type KnownUsages = LibraryUsages | { readonly failed: string } | null;

interface UsageItem {
  readonly key: string;
  readonly usage: LibraryUsage;
}

const NONE: ReadonlySet<string> = new Set();

interface UsagesProps {
  readonly library: LibraryName;
  readonly onClose: () => void;
}

export function Usages({ library, onClose }: UsagesProps) {
  const host = useHost();
  const known = useUsages(library);
  const rows = useMemo<readonly UsageItem[]>(
    () =>
      known && "usages" in known
        ? known.usages.map((usage, index) => ({ key: `${index}`, usage }))
        : [],
    [known],
  );
  const open = ({ usage }: UsageItem) => void goToUsage(host, usage);
  return (
    <Section
      title={`Uses of ${library.name}`}
      count={rows.length}
      actions={<IconButton label="Close the list" icon={<X size={14} />} onClick={onClose} />}
    >
      {known === null && <div className="libraries-soft">Searching all machines…</div>}
      {known && "failed" in known && <div className="libraries-failed">{known.failed}</div>}
      {known && "usages" in known && rows.length === 0 && (
        <Empty
          title="Not used"
          text="No machine in the projects and library roots uses this library."
        />
      )}
      {rows.length > 0 && (
        <div className="libraries-usages">
          <Tree
            label={`Uses of ${library.name}`}
            roots={rows}
            id={({ key }) => key}
            childrenOf={() => null}
            expanded={NONE}
            onExpand={() => undefined}
            text={({ usage }) => `${place(usage)}, ${usage.names.join(" / ")}`}
            row={({ usage }) => <UsageRow usage={usage} />}
            rowHeight={40}
            onSelect={open}
            onOpen={open}
          />
        </div>
      )}
      {known && "is_cut" in known && known.is_cut && (
        <div className="libraries-soft">Not all uses are shown.</div>
      )}
    </Section>
  );
}

function useUsages({ path, name }: LibraryName): KnownUsages {
  const { context } = useHost();
  const [known, setKnown] = useState<KnownUsages>(null);
  useEffect(() => {
    let wanted = true;
    setKnown(null);
    const query = `path=${encodeURIComponent(path)}&name=${encodeURIComponent(name)}`;
    const tell = (found: KnownUsages) => wanted && setKnown(found);
    context()
      .page.server.request<LibraryUsages>("GET", `/libraries/usages?${query}`)
      .then(tell, (error: unknown) =>
        tell({ failed: error instanceof Error ? error.message : String(error) }),
      );
    return () => {
      wanted = false;
    };
  }, [path, name, context]);
  return known;
}

function place({ file, library }: LibraryUsage): string {
  if (library) return `${library.path}/${library.name}`;
  return file?.path ?? "a machine outside the projects";
}

function UsageRow({ usage }: { readonly usage: LibraryUsage }) {
  return (
    <span className="libraries-usage" title={`${place(usage)}\n${usage.names.join(" / ")}`}>
      <span className="libraries-cut">{usage.names.at(-1)}</span>
      <span className="libraries-cut libraries-soft">
        {place(usage)}
        {usage.machine === null ? "" : " · open"} · {usage.names.slice(0, -1).join(" / ")}
      </span>
    </span>
  );
}

async function goToUsage(host: PanelHost, { machine, file, path }: LibraryUsage): Promise<void> {
  const { page } = host.context();
  try {
    const there = page.tabs.peek().find(({ session }) => session.id === machine);
    const tab = there ?? (machine !== null ? await page.join(machine) : null);
    const found = tab ?? (file ? await page.open(file) : null);
    if (found) goTo(host, found, { kind: "state", path });
    else {
      page.tell({
        level: "warning",
        text: "The machine is not in any of the server's projects. Start the server with that folder as well.",
      });
    }
  } catch (error) {
    page.tell({ level: "error", text: error instanceof Error ? error.message : String(error) });
  }
}
