/** Menus: entries with keys, marks and menus of their own; by mouse and by keyboard. */

import { Check, ChevronRight } from "lucide-react";
import { type KeyboardEvent, type ReactNode, useLayoutEffect, useRef, useState } from "react";
import { createPortal } from "react-dom";
import "./menu.css";

export type MenuItem =
  | "separator"
  | {
      readonly id: string;
      readonly title: string;
      /** As they are shown. */
      readonly keys?: string | undefined;
      readonly icon?: ReactNode;
      /** State of a toggle. */
      readonly checked?: boolean | undefined;
      readonly disabled?: boolean | undefined;
      /** Tooltip: the reason, or a description. */
      readonly detail?: string | undefined;
      readonly items?: readonly MenuItem[] | undefined;
      readonly run?: (() => void) | undefined;
    };

export interface ContextMenuProps {
  /** Accessible name. */
  readonly label: string;
  /** Preferred position of the top left corner, in CSS pixels of the window. */
  readonly at: { readonly x: number; readonly y: number };
  readonly items: readonly MenuItem[];
  readonly onClose: () => void;
  /** Moves to the previous or next menu of a menu bar. */
  readonly onSideways?: ((step: -1 | 1) => void) | undefined;
}

/** A menu at a position of the component's window. */
export function ContextMenu({ label, at, items, onClose, onSideways }: ContextMenuProps) {
  const anchor = useRef<HTMLSpanElement>(null);
  const [host, setHost] = useState<Element | null>(null);
  const before = useRef<Element | null>(null);
  useLayoutEffect(() => {
    const page = anchor.current?.ownerDocument;
    if (!page) return;
    before.current = page.activeElement;
    const dialogs = page.querySelectorAll("dialog[open]");
    setHost(dialogs.item(dialogs.length - 1) ?? page.body);
  }, []);
  const close = () => {
    if (before.current instanceof HTMLElement) before.current.focus();
    onClose();
  };
  return (
    <span ref={anchor} hidden>
      {host &&
        createPortal(
          <section aria-label={`Menu ${label}`}>
            {/* biome-ignore lint/a11y/noStaticElementInteractions: Escape does the same */}
            <div
              className="menu-shield"
              style={onSideways ? { top: at.y } : undefined}
              onMouseDown={(event) => {
                event.preventDefault();
                close();
              }}
              onContextMenu={(event) => {
                event.preventDefault();
                close();
              }}
            />
            <Menu label={label} at={at} items={items} onClose={close} onSideways={onSideways} />
          </section>,
          host,
        )}
    </span>
  );
}

interface MenuProps extends ContextMenuProps {
  /** Closes this menu only, and not those around it. */
  readonly onBack?: (() => void) | undefined;
}

function Menu({ label, at, items, onClose, onSideways, onBack }: MenuProps) {
  const place = useRef<HTMLDivElement>(null);
  const [open, setOpen] = useState<string | null>(null);
  useLayoutEffect(() => {
    const menu = place.current;
    const view = menu?.ownerDocument.defaultView;
    if (!menu || !view) return;
    const box = menu.getBoundingClientRect();
    const left = Math.max(4, Math.min(at.x, view.innerWidth - box.width - 4));
    const top = Math.max(4, Math.min(at.y, view.innerHeight - box.height - 4));
    menu.style.left = `${left}px`;
    menu.style.top = `${top}px`;
    entries(menu)[0]?.focus({ preventScroll: true });
  }, [at.x, at.y]);
  const key = (event: KeyboardEvent<HTMLElement>) => {
    event.stopPropagation();
    const handled = menuKey(event.key, place.current, { onClose, onBack, onSideways, setOpen });
    if (handled) event.preventDefault();
  };
  return (
    <div ref={place} className="menu" role="menu" aria-label={label} onKeyDown={key} tabIndex={-1}>
      {items.map((item, index) =>
        item === "separator" ? (
          // biome-ignore lint/suspicious/noArrayIndexKey: a line has no name, and menus do not change while they are open
          <hr key={`line ${index}`} className="menu-separator" />
        ) : (
          <Entry
            key={item.id}
            item={item}
            open={open === item.id}
            setOpen={setOpen}
            onClose={onClose}
          />
        ),
      )}
    </div>
  );
}

interface MenuEntryProps {
  readonly item: Exclude<MenuItem, "separator">;
  readonly open: boolean;
  readonly setOpen: (id: string | null) => void;
  readonly onClose: () => void;
}

function Entry({ item, open, setOpen, onClose }: MenuEntryProps) {
  const place = useRef<HTMLButtonElement>(null);
  const box = open ? place.current?.getBoundingClientRect() : undefined;
  const press = () => {
    if (item.disabled) return;
    if (item.items) return setOpen(item.id);
    onClose();
    item.run?.();
  };
  const role = item.checked === undefined ? "menuitem" : "menuitemcheckbox";
  return (
    <>
      <button
        ref={place}
        type="button"
        className="menu-item"
        role={role}
        tabIndex={-1}
        title={item.detail}
        data-id={item.id}
        {...(item.checked === undefined ? {} : { "aria-checked": item.checked })}
        aria-disabled={item.disabled}
        aria-haspopup={item.items ? "menu" : undefined}
        aria-expanded={item.items ? open : undefined}
        onMouseEnter={(event) => {
          event.currentTarget.focus({ preventScroll: true });
          setOpen(item.items && !item.disabled ? item.id : null);
        }}
        onClick={press}
      >
        <span className="menu-mark" aria-hidden>
          {item.checked ? <Check size={14} /> : item.icon}
        </span>
        <span className="menu-title">{item.title}</span>
        {item.keys && <span className="menu-keys">{item.keys}</span>}
        {item.items && <ChevronRight size={14} aria-hidden />}
      </button>
      {open && item.items && box && (
        <Menu
          label={item.title}
          at={{ x: box.right - 2, y: box.top - 4 }}
          items={item.items}
          onClose={onClose}
          onBack={() => {
            setOpen(null);
            place.current?.focus();
          }}
        />
      )}
    </>
  );
}

interface MenuSteps {
  readonly onClose: () => void;
  readonly onBack: (() => void) | undefined;
  readonly onSideways: ((step: -1 | 1) => void) | undefined;
  readonly setOpen: (id: string | null) => void;
}

/** Entries of the menu itself, without those of menus inside. */
function entries(menu: HTMLElement): HTMLElement[] {
  return [...menu.querySelectorAll<HTMLElement>(":scope > .menu-item")];
}

function menuKey(key: string, menu: HTMLElement | null, steps: MenuSteps): boolean {
  if (!menu) return false;
  const all = entries(menu);
  const at = all.indexOf(menu.ownerDocument.activeElement as HTMLElement);
  const now = all[at];
  const focus = (index: number) => all.at(index % all.length)?.focus();
  switch (key) {
    case "ArrowDown":
      focus(at + 1);
      return true;
    case "ArrowUp":
      focus(at <= 0 ? -1 : at - 1);
      return true;
    case "Home":
      focus(0);
      return true;
    case "End":
      focus(-1);
      return true;
    case "ArrowRight":
      if (now?.getAttribute("aria-haspopup")) steps.setOpen(now.dataset["id"] ?? null);
      else steps.onSideways?.(1);
      return true;
    case "ArrowLeft":
      if (steps.onBack) steps.onBack();
      else steps.onSideways?.(-1);
      return true;
    case "Escape":
      (steps.onBack ?? steps.onClose)();
      return true;
    case "Tab":
      steps.onClose();
      return true;
    default:
      return typeahead(key, all, at);
  }
}

function typeahead(key: string, all: readonly HTMLElement[], at: number): boolean {
  if (key.length !== 1 || key === " ") return false;
  const wanted = key.toLowerCase();
  for (let step = 1; step <= all.length; step++) {
    const entry = all[(at + step) % all.length];
    const title = entry?.querySelector(".menu-title")?.textContent ?? "";
    if (title.toLowerCase().startsWith(wanted)) {
      entry?.focus();
      return true;
    }
  }
  return false;
}
