/** The containers of the selection; each one is a link. */

import { ChevronRight } from "lucide-react";
import { Fragment, useEffect, useRef, useState } from "react";
import { elementOf } from "../model/element.ts";
import type { Point } from "../model/geometry.ts";
import { lineage } from "../model/path.ts";
import type { OpenTab } from "../store/page/page.ts";
import { select } from "../store/page/view.ts";
import { ContextMenu } from "../ui/menu.tsx";
import { useComputed, useSignal } from "../ui/signals.ts";
import { crumbsIn } from "./crumbs.ts";
import { useSession } from "./session_context.tsx";

export function Breadcrumb({ tab }: { tab: OpenTab }) {
  const { canvas } = useSession();
  const { machine } = tab.session;
  const place = useRef<HTMLElement>(null);
  const [room_px, setRoom] = useState(0);
  useEffect(() => {
    const { current: nav } = place;
    if (!nav) return;
    const sizes = new ResizeObserver(() => setRoom(nav.clientWidth));
    sizes.observe(nav);
    return () => sizes.disconnect();
  }, []);
  useSignal(tab.session.version);
  const path = useComputed(() => {
    const [key] = tab.view.selection.value;
    const selected = key === undefined ? undefined : elementOf(key)?.path;
    return selected ?? canvas.value?.workingContainer.value ?? machine.root;
  }, [tab, canvas]);
  const go = (to: string) => {
    select(tab.view, [{ kind: "state", path: to }]);
    canvas.peek()?.fit([to]);
  };
  const crumbs = lineage(path).map((at) => ({ at, name: machine.state(at)?.name ?? at }));
  const { from, to } = crumbsIn(
    crumbs.map(({ name }) => name),
    room_px,
  );
  return (
    <nav ref={place} className="breadcrumb" aria-label="Breadcrumb">
      <ol>
        {crumbs.map(({ at, name }, index) => (
          <Fragment key={at}>
            {index > 0 && (index <= from || index >= to) && <ChevronRight size={13} aria-hidden />}
            {index === from && to > from && <Between crumbs={crumbs.slice(from, to)} go={go} />}
            {(index < from || index >= to) && (
              <li>
                <button
                  type="button"
                  title={name}
                  aria-current={at === path ? "location" : undefined}
                  onClick={() => go(at)}
                >
                  {name}
                </button>
              </li>
            )}
          </Fragment>
        ))}
      </ol>
    </nav>
  );
}

interface Crumb {
  readonly at: string;
  readonly name: string;
}

/** The states for which there is no room, as a menu. */
function Between({ crumbs, go }: { crumbs: readonly Crumb[]; go: (to: string) => void }) {
  const [menu, setMenu] = useState<Point | null>(null);
  const words = crumbs.length === 1 ? "1 state in between" : `${crumbs.length} states in between`;
  return (
    <li className="breadcrumb-more">
      <button
        type="button"
        aria-label={words}
        aria-haspopup="menu"
        title={crumbs.map(({ name }) => name).join(" › ")}
        onClick={(event) => {
          const { left, bottom } = event.currentTarget.getBoundingClientRect();
          setMenu({ x: left, y: bottom });
        }}
      >
        …
      </button>
      {menu && (
        <ContextMenu
          label={words}
          at={menu}
          items={crumbs.map(({ at, name }) => ({ id: at, title: name, run: () => go(at) }))}
          onClose={() => setMenu(null)}
        />
      )}
    </li>
  );
}
