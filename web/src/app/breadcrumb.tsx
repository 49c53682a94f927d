/** Where one is: the states around what is selected, each a way back out. */

import { ChevronRight } from "lucide-react";
import { Fragment, useState } from "react";
import { elementOf } from "../model/element.ts";
import { lineage } from "../model/path.ts";
import type { OpenTab } from "../store/page.ts";
import { select } from "../store/view.ts";
import { useSignal } from "../ui/signals.ts";
import { useDerived, useSession } from "./provided.tsx";

/** So many of the innermost states are always named; those between them and the root give way. */
const LAST_SHOWN = 3;

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
  const [expanded, setExpanded] = useState<string | null>(null);
  const all = lineage(path);
  const hidden = expanded === path ? [] : all.slice(1, -LAST_SHOWN);
  const isHidden = hidden.length > 1;
  const crumbs = isHidden ? all.filter((outer) => !hidden.includes(outer)) : all;
  return (
    <nav className="breadcrumb" aria-label="Where you are">
      <ol>
        {crumbs.map((outer, index) => (
          <Fragment key={outer}>
            {index > 0 && <ChevronRight size={13} aria-hidden />}
            {index === 1 && isHidden && (
              <>
                <li className="breadcrumb-more">
                  <button
                    type="button"
                    aria-label={`Show the ${hidden.length} states between`}
                    title={hidden.map((each) => machine.state(each)?.name ?? each).join(" › ")}
                    onClick={() => setExpanded(path)}
                  >
                    …
                  </button>
                </li>
                <ChevronRight size={13} aria-hidden />
              </>
            )}
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
