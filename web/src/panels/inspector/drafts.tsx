/** List of texts that were entered here but not applied. A draft stays listed until it is applied or discarded. */

import { Trash2 } from "lucide-react";
import { draftKey, drafts, type FieldDraft } from "../../store/document/drafts.ts";
import { IconButton } from "../../ui/button.tsx";
import { useSignal } from "../../ui/signals.ts";
import { Fold } from "./fold.tsx";
import type { InspectorContext } from "./inspector_context.ts";

export function Drafts({ context }: { context: InspectorContext }) {
  const all = useSignal(drafts.all);
  const own = [...all.values()].filter(({ machine }) => machine === context.tab.session.id);
  if (own.length === 0) return null;
  return (
    <Fold title="Not applied yet" count={own.length}>
      <ul className="inspector-list">
        {own.map((draft) => (
          <Row key={draftKey(draft)} context={context} draft={draft} />
        ))}
      </ul>
    </Fold>
  );
}

function Row({ context, draft }: { context: InspectorContext; draft: FieldDraft }) {
  const { path, field, text } = draft;
  const state = context.machine.state(path);
  return (
    <li className="inspector-draft">
      {state ? (
        <button
          type="button"
          className="inspector-link"
          onClick={() => context.show({ kind: "state", path })}
        >
          {field} of {state.name}
        </button>
      ) : (
        <details>
          <summary>
            {field} of {context.tab.session.named(path)}, which no longer exists
          </summary>
          <pre>{text}</pre>
        </details>
      )}
      <IconButton
        className="inspector-mini"
        label={`Discard the ${field} of ${state?.name ?? context.tab.session.named(path)}`}
        icon={<Trash2 size={13} />}
        onClick={() => drafts.drop(draft)}
      />
    </li>
  );
}
