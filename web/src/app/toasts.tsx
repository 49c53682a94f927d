/** Notices for some seconds at the lower edge. All of them stay in the log. */

import { CircleAlert, Info, TriangleAlert, X } from "lucide-react";
import { useEffect, useRef, useState } from "react";
import type { Notice } from "../store/page.ts";
import { Button, IconButton } from "../ui/button.tsx";
import { useSignal } from "../ui/signals.ts";
import { useSession } from "./provided.tsx";
import "./toasts.css";

/** So long a notice stays, by how much it matters; the pointer holds it. */
const SHOWN_MS = { info: 5_000, warning: 10_000, error: 30_000 };
const SHOWN_MAX = 4;

export function Toasts() {
  const { page } = useSession();
  const notices = useSignal(page.notices);
  const [first] = useState(() => page.notices.peek().at(-1)?.id ?? 0);
  const [gone, setGone] = useState<ReadonlySet<number>>(new Set());
  const shown = notices
    .filter(({ id, isQuiet }) => id > first && !isQuiet && !gone.has(id))
    .slice(-SHOWN_MAX);
  const drop = (id: number) => setGone((before) => new Set(before).add(id));
  return (
    <section className="toasts" aria-label="Notices" aria-live="polite">
      {shown.map((notice) => (
        <Toast key={notice.id} notice={notice} onClose={() => drop(notice.id)} />
      ))}
    </section>
  );
}

const ICONS = { info: Info, warning: TriangleAlert, error: CircleAlert };

function Toast({ notice, onClose }: { notice: Notice; onClose: () => void }) {
  const { commands, context } = useSession();
  const [held, setHeld] = useState(false);
  const last = useRef(onClose);
  last.current = onClose;
  useEffect(() => {
    if (held) return;
    const timer = setTimeout(() => last.current(), SHOWN_MS[notice.level]);
    return () => clearTimeout(timer);
  }, [notice.level, held]);
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
      <span className="toast-text">{notice.text}</span>
      {action && (
        <Button
          onClick={() => {
            onClose();
            commands.run(action.command, context(), action.argument);
          }}
        >
          {action.title}
        </Button>
      )}
      <IconButton label="Close notice" icon={<X size={14} />} onClick={onClose} />
    </div>
  );
}
