/** Where one is: the states around what is selected, each a way back out. */

import { ChevronRight } from "lucide-react";
import { Fragment } from "react";
import { elementOf } from "../model/element.ts";
import { lineage } from "../model/path.ts";
import type { OpenTab } from "../store/page.ts";
import { select } from "../store/view.ts";
import { useSignal } from "../ui/signals.ts";
import { useDerived, useSession } from "./provided.tsx";

export function Breadcrumb({ tab }: { tab: OpenTab }) {
  const { canvas } = useSession();
  const { machine } = tab.room;
  useSignal(tab.room.version);
  const path = useDerived(() => {
    const [key] = tab.view.selection.value;
    const selected = key === undefined ? undefined : elementOf(key)?.path;
    return selected ?? canvas.value?.stage.value ?? machine.root;
  }, [tab, canvas]);
  const go = (to: string) => {
    select(tab.view, [{ kind: "state", path: to }]);
    canvas.peek()?.fit([to]);
  };
  return (
    <nav className="breadcrumb" aria-label="Where you are">
      <ol>
        {lineage(path).map((outer, index) => (
          <Fragment key={outer}>
            {index > 0 && <ChevronRight size={13} aria-hidden />}
            <li>
              <button
                type="button"
                aria-current={outer === path ? "location" : undefined}
                onClick={() => go(outer)}
              >
                {machine.state(outer)?.name ?? outer}
              </button>
            </li>
          </Fragment>
        ))}
      </ol>
    </nav>
  );
}
