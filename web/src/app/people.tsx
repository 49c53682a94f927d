/** Other users of the current machine. */

import type { Presence } from "../model/generated/protocol.ts";
import type { OpenTab } from "../store/page/page.ts";
import { select } from "../store/page/view.ts";
import { useSignal } from "../ui/signals.ts";
import { useSession } from "./session_context.tsx";

export function People() {
  const { page } = useSession();
  const tab = useSignal(page.active);
  return tab && <InSession tab={tab} />;
}

function InSession({ tab }: { tab: OpenTab }) {
  const { canvas } = useSession();
  const people = useSignal(tab.session.people);
  if (people.length === 0) return null;
  const go = ({ selection }: Presence) => {
    if (selection.length === 0) return;
    select(
      tab.view,
      selection.map((path) => ({ kind: "state" as const, path })),
    );
    canvas.peek()?.fit(selection);
  };
  return (
    <ul className="people" aria-label="Other users in this machine">
      {people.map((person) => (
        <li key={person.connection}>
          <button
            type="button"
            className={`person person-${person.connection % 6}`}
            title={`${person.user} is here: go to their selection`}
            onClick={() => go(person)}
          >
            {person.user}
          </button>
        </li>
      ))}
    </ul>
  );
}
