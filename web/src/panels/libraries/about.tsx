/** Details of a library: its description, outcomes and ports. */

import { useEffect, useState } from "react";
import { libraryMachine } from "../../commands/insert.ts";
import type { LibraryName, PortDocument, StateDocument } from "../../model/generated/protocol.ts";
import { outcomesOf, portsOf } from "../../model/machine.ts";
import { shortType } from "../../model/types.ts";
import { Section } from "../../ui/section.tsx";
import { useHost } from "../context.tsx";

type KnownRoot = StateDocument | { readonly failed: string } | null;

export function About({ library }: { readonly library: LibraryName }) {
  const known = useRoot(library);
  return (
    <Section title={library.name}>
      <div className="libraries-about">
        <div className="libraries-path">{`${library.path}/${library.name}`}</div>
        {known === null && <div className="libraries-soft">Reading…</div>}
        {known && "failed" in known && <div className="libraries-failed">{known.failed}</div>}
        {known && !("failed" in known) && <Interface root={known} />}
      </div>
    </Section>
  );
}

/** Root state of the library's machine; null until it is loaded. */
function useRoot(library: LibraryName): KnownRoot {
  const { context } = useHost();
  const [known, setKnown] = useState<KnownRoot>(null);
  useEffect(() => {
    let wanted = true;
    setKnown(null);
    const tell = (found: KnownRoot) => wanted && setKnown(found);
    libraryMachine(context(), library).then(
      ({ states: [root] }) => tell(root ?? { failed: "The library is empty." }),
      (error: unknown) => tell({ failed: error instanceof Error ? error.message : String(error) }),
    );
    return () => {
      wanted = false;
    };
  }, [library, context]);
  return known;
}

function Interface({ root }: { readonly root: StateDocument }) {
  const outcomes = outcomesOf(root).filter(({ id }) => id >= 0);
  return (
    <>
      {root.description && <p className="libraries-description">{root.description}</p>}
      <dl className="libraries-interface">
        <Ports title="Inputs" ports={portsOf(root, "input")} />
        <Ports title="Outputs" ports={portsOf(root, "output")} />
        <dt>Outcomes</dt>
        <dd>{outcomes.map(({ name }) => name).join(", ") || "only aborted and preempted"}</dd>
      </dl>
    </>
  );
}

function Ports({
  title,
  ports,
}: {
  readonly title: string;
  readonly ports: readonly PortDocument[];
}) {
  if (ports.length === 0) return null;
  const words = ports.map(({ name, data_type }) => `${name}: ${shortType(data_type)}`);
  return (
    <>
      <dt>{title}</dt>
      <dd>{words.join(", ")}</dd>
    </>
  );
}
