/** Open notices with their actions, so that no important one disappears with its toast. */

import { Bell, CircleAlert, Info, TriangleAlert, X } from "lucide-react";
import { type KeyboardEvent, useEffect, useRef, useState } from "react";
import { useHost } from "../panels/context.tsx";
import { goTo } from "../panels/go_to.ts";
import { closeNotices, noticeText, offeredNotices, openNotices } from "../store/page/notices.ts";
import type { Notice } from "../store/page/page.ts";
import { timeScale, wallTime } from "../store/page/times.ts";
import { Button, IconButton } from "../ui/button.tsx";
import { useSignal } from "../ui/signals.ts";
import { useSession } from "./session_context.tsx";
import "./notice_centre.css";

/** The button in the upper edge, with how many notices nobody has seen here. */
export function NoticeBell() {
  const session = useSession();
  const notices = useSignal(session.page.notices);
  const [isOpen, setOpen] = useState(false);
  const [seen, setSeen] = useState(() => notices.at(-1)?.id ?? 0);
  const open = openNotices(notices);
  const fresh = isOpen ? [] : open.filter(({ id }) => id > seen);
  const toggle = () => {
    setSeen(notices.at(-1)?.id ?? 0);
    setOpen(!isOpen);
  };
  const close = () => {
    setSeen(notices.at(-1)?.id ?? 0);
    setOpen(false);
  };
  const label = fresh.length === 0 ? "Notices" : `Notices: ${fresh.length} new`;
  return (
    <div className="notice-place">
      <button
        type="button"
        className={`icon-button notice-bell ${worstOf(fresh)}`}
        aria-label={label}
        title={label}
        aria-expanded={isOpen}
        onClick={toggle}
      >
        <Bell size={16} aria-hidden />
        {fresh.length > 0 && <span className="notice-count">{Math.min(fresh.length, 99)}</span>}
      </button>
      {isOpen && <NoticeCentre open={open} onClose={close} />}
    </div>
  );
}

function worstOf(notices: readonly Notice[]): string {
  const worst = (["error", "warning", "info"] as const).find((level) =>
    notices.some((notice) => notice.level === level),
  );
  return worst ? `notice-bell-${worst}` : "";
}

function NoticeCentre({ open, onClose }: { open: readonly Notice[]; onClose: () => void }) {
  const session = useSession();
  const place = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const before = document.activeElement;
    place.current?.focus();
    return () => {
      if (before instanceof HTMLElement && before.isConnected) before.focus();
    };
  }, []);
  const { page } = session;
  const dropped = useSignal(page.droppedNotices);
  const offered = offeredNotices(open);
  const closeAll = () => {
    closeNotices(page, offered);
    page.droppedNotices.value = 0;
  };
  const last = useRef(onClose);
  last.current = onClose;
  useEffect(() => {
    const pressed = ({ target }: PointerEvent) => {
      const around = place.current?.parentElement;
      if (around && target instanceof Node && !around.contains(target)) last.current();
    };
    document.addEventListener("pointerdown", pressed);
    return () => document.removeEventListener("pointerdown", pressed);
  }, []);
  const key = (event: KeyboardEvent) => {
    if (event.key !== "Escape") return;
    event.stopPropagation();
    onClose();
  };
  return (
    <section
      ref={place}
      className="notice-centre"
      aria-label="Notice centre"
      tabIndex={-1}
      onKeyDown={key}
    >
      <div className="notice-head">
        <h2 className="notice-title">Notices</h2>
        {(open.length > 0 || dropped > 0) && (
          <Button kind="quiet" onClick={closeAll}>
            Close all
          </Button>
        )}
      </div>
      {open.length === 0 ? (
        <p className="notice-none">No notices. The log keeps earlier ones.</p>
      ) : (
        <ul className="notice-list">
          {offered.map((notice) => (
            <Line key={notice.id} notice={notice} onLeave={onClose} />
          ))}
        </ul>
      )}
      <More count={open.length - offered.length} dropped={dropped} />
    </section>
  );
}

/** Numbers of notices that are not listed. */
function More({ count, dropped }: { readonly count: number; readonly dropped: number }) {
  if (count === 0 && dropped === 0) return null;
  return (
    <p className="notice-more">
      {count > 0 &&
        `Not listed: ${inWords(count)}. Close some notices to see them, or open the log. `}
      {dropped > 0 && `Dropped: ${inWords(dropped)}. Too many were open.`}
    </p>
  );
}

function inWords(count: number): string {
  return `${count.toLocaleString("en")} ${count === 1 ? "notice" : "notices"}`;
}

const SIGNS = { info: Info, warning: TriangleAlert, error: CircleAlert };

function Line({ notice, onLeave }: { notice: Notice; onLeave: () => void }) {
  const session = useSession();
  const host = useHost();
  useSignal(timeScale);
  const { action, about, level, at_ms } = notice;
  const Icon = SIGNS[level];
  const close = () => closeNotices(session.page, [notice]);
  const tab =
    about &&
    session.page.tabs
      .peek()
      .find(({ session: machineSession }) => machineSession.id === about.machine);
  const element = about?.element;
  return (
    <li className={`notice notice-${level}`}>
      <Icon size={15} aria-hidden />
      <div className="notice-body">
        <span className="notice-text">{noticeText(notice)}</span>
        <span className="notice-foot">
          <time>{wallTime(at_ms, Date.now())}</time>
          {tab && element && (
            <Button
              kind="quiet"
              onClick={() => {
                onLeave();
                goTo(host, tab, element);
              }}
            >
              Show
            </Button>
          )}
          {action && (
            <Button
              onClick={() => {
                close();
                session.commands.call(action, session.context());
              }}
            >
              {action.title}
            </Button>
          )}
        </span>
      </div>
      <IconButton label="Close notice" icon={<X size={14} />} onClick={close} />
    </li>
  );
}
