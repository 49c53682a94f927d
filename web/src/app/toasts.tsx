/** Notices for some seconds at the lower edge. The notice centre keeps them until they are closed, the log for longer. */

import { CircleAlert, Info, TriangleAlert, X } from "lucide-react";
import { useEffect, useLayoutEffect, useRef, useState } from "react";
import { MISSION_PANEL } from "../commands/mission.ts";
import { closeNotices, keyOfNotice, noticeText } from "../store/page/notices.ts";
import type { Notice } from "../store/page/page.ts";
import { Button, IconButton } from "../ui/button.tsx";
import { useComputed, useSignal } from "../ui/signals.ts";
import { useSession } from "./session_context.tsx";
import "./toasts.css";

/** Time that a toast stays, by its level. The pointer holds it. News of runs disappear sooner, because mission control has them. */
const SHOWN_MS = { info: 5_000, warning: 10_000, error: 30_000 };
const PASSING_MS = 8_000;
const SHOWN_MAX = 4;

export function Toasts() {
  const session = useSession();
  const { page, dock } = session;
  /** The machine whose run is in mission control, which shows its news. */
  const machineInMission = useComputed(() => {
    const machine = page.active.value?.session.id ?? null;
    return dock.value.isInSight(MISSION_PANEL) ? machine : null;
  }, [page, dock]);
  const isAside = useComputed(() => dock.value.isInSight(MISSION_PANEL), [dock]);
  const notices = useSignal(page.notices);
  const [first, setFirst] = useState(() => page.notices.peek().at(-1)?.id ?? 0);
  const [gone, setGone] = useState<ReadonlySet<number>>(new Set());
  const fresh = notices
    .filter(({ id, isQuiet, isClosed }) => id > first && !isQuiet && !isClosed && !gone.has(id))
    .filter(({ passing }) => !passing || passing.machine !== machineInMission);
  const shown = fresh.slice(-SHOWN_MAX);
  const drop = (id: number) => setGone((before) => new Set(before).add(id));
  // Displaced toasts are not shown later, because the notice centre has them.
  const pushed = fresh.at(-SHOWN_MAX - 1)?.id ?? 0;
  useEffect(() => setFirst((before) => Math.max(before, pushed)), [pushed]);
  useLeaving((machine) => {
    const left = shown.filter((notice) => machineOf(notice) === machine).map(({ id }) => id);
    if (left.length > 0) setGone((before) => new Set([...before, ...left]));
  });
  const area = useCanvasArea(shown.length > 0);
  return (
    <section
      className={area ? "toasts toasts-on-canvas" : isAside ? "toasts toasts-aside" : "toasts"}
      style={area ?? undefined}
      aria-label="Notices"
      aria-live="polite"
    >
      {shown.map((notice) => (
        <Toast
          key={keyOfNotice(notice)}
          notice={notice}
          onTimeout={() => drop(notice.id)}
          onClose={() => closeNotices(page, [notice])}
        />
      ))}
    </section>
  );
}

/** The least size of a canvas that has room for toasts, in CSS pixels. */
const ROOM = { width: 320, height: 160 };
const EDGE_PX = 12;
/** Width of the overview, which is in the lower right corner. */
const OVERVIEW_PX = 180;
/** Least and largest width of toasts. */
const WIDTH_PX = { least: 290, most: 720 };

interface ToastArea {
  readonly left: number;
  readonly bottom: number;
  readonly maxWidth: number;
}

/** Place of toasts on the canvas; null if the canvas is not in sight or too small. */
function useCanvasArea(hasToasts: boolean): ToastArea | null {
  const canvas = useSignal(useSession().canvas);
  const [area, setArea] = useState<ToastArea | null>(null);
  useLayoutEffect(() => {
    const place = canvas && hasToasts ? document.querySelector(".canvas-place") : null;
    if (!place) return setArea(null);
    const measure = () => {
      const box = place.getBoundingClientRect();
      const isRoomy = box.width >= ROOM.width && box.height >= ROOM.height;
      if (!isRoomy) return setArea(null);
      setArea({
        left: box.left + EDGE_PX,
        bottom: window.innerHeight - box.bottom + EDGE_PX,
        maxWidth: Math.min(
          WIDTH_PX.most,
          Math.max(WIDTH_PX.least, box.width - OVERVIEW_PX - 2 * EDGE_PX),
        ),
      });
    };
    measure();
    const sizes = new ResizeObserver(measure);
    sizes.observe(place);
    return () => sizes.disconnect();
  }, [canvas, hasToasts]);
  return area;
}

function machineOf({ about, passing }: Notice): string | undefined {
  return passing?.machine ?? about?.machine;
}

/** The earlier machine after a change of the current one: its notices would be shown over the other machine. */
function useLeaving(left: (machine: string) => void): void {
  const { page } = useSession();
  const machine = useSignal(page.active)?.session.id;
  const before = useRef(machine);
  useEffect(() => {
    const was = before.current;
    before.current = machine;
    if (was !== undefined && was !== machine) left(was);
  });
}

const ICONS = { info: Info, warning: TriangleAlert, error: CircleAlert };

interface ToastProps {
  readonly notice: Notice;
  readonly onTimeout: () => void;
  readonly onClose: () => void;
}

function Toast({ notice, onTimeout, onClose }: ToastProps) {
  const { commands, context } = useSession();
  const [held, setHeld] = useState(false);
  const last = useRef(onTimeout);
  last.current = onTimeout;
  useEffect(() => {
    if (held) return;
    const shown_ms = notice.passing ? PASSING_MS : SHOWN_MS[notice.level];
    const timer = setTimeout(() => last.current(), shown_ms);
    return () => clearTimeout(timer);
  }, [notice, held]);
  const Icon = ICONS[notice.level];
  const { action } = notice;
  return (
    // biome-ignore lint/a11y/noStaticElementInteractions: it stays while the pointer rests on it
    <div
      className={`toast toast-${notice.level}`}
      onMouseEnter={() => setHeld(true)}
      onMouseLeave={() => setHeld(false)}
    >
      <Icon size={16} aria-hidden />
      <span className="toast-text">{noticeText(notice)}</span>
      {action && (
        <Button
          onClick={() => {
            onClose();
            commands.call(action, context());
          }}
        >
          {action.title}
        </Button>
      )}
      <IconButton label="Close notice" icon={<X size={14} />} onClick={onClose} />
    </div>
  );
}
