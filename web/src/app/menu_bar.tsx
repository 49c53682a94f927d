/** The menus of the page, made from the list of commands. */

import { type KeyboardEvent, useRef, useState } from "react";
import { barMenu, menuTitles } from "../commands/menus.ts";
import { ContextMenu } from "../ui/menu.tsx";
import { useKeys } from "./keys_shown.ts";
import { useSession } from "./session_context.tsx";

export function MenuBar() {
  const { commands, context } = useSession();
  const keys = useKeys();
  const place = useRef<HTMLDivElement>(null);
  const titles: readonly string[] = menuTitles(commands);
  const [open, setOpen] = useState<{ title: string; x: number; y: number } | null>(null);
  const [reached, setReached] = useState(0);
  const button = (index: number) =>
    place.current?.querySelectorAll<HTMLElement>("[role=menuitem]")[index];
  const show = (index: number) => {
    const at = (index + titles.length) % titles.length;
    const box = button(at)?.getBoundingClientRect();
    const title = titles[at];
    if (!box || title === undefined) return;
    button(at)?.focus();
    setReached(at);
    setOpen({ title, x: box.left, y: box.bottom + 2 });
  };
  const key = (event: KeyboardEvent) => {
    const steps: Record<string, number> = { ArrowRight: 1, ArrowLeft: -1 };
    const by = steps[event.key];
    if (by !== undefined) {
      const at = (reached + by + titles.length) % titles.length;
      setReached(at);
      button(at)?.focus();
    } else if (event.key === "ArrowDown") show(reached);
    else return;
    event.preventDefault();
  };
  return (
    <div
      ref={place}
      className="menu-bar"
      role="menubar"
      aria-label="Menus"
      onKeyDown={key}
      tabIndex={-1}
    >
      {titles.map((title, index) => (
        <button
          key={title}
          type="button"
          role="menuitem"
          aria-haspopup="menu"
          aria-expanded={open?.title === title}
          tabIndex={index === reached ? 0 : -1}
          className="menu-bar-title"
          onClick={() => show(index)}
          onMouseEnter={() => open && show(index)}
        >
          {title}
        </button>
      ))}
      {open && (
        <ContextMenu
          key={open.title}
          label={open.title}
          at={open}
          items={barMenu({ commands, context: context(), keys }, open.title)}
          onClose={() => setOpen(null)}
          onSideways={(step) => show(titles.indexOf(open.title) + step)}
        />
      )}
    </div>
  );
}
