/** Text field over a name that renames in place. */

import type { Box } from "../model/geometry.ts";

interface Renaming {
  readonly place: HTMLElement;
  /** Box of the name, in CSS pixels of `place`. */
  readonly box: Box;
  readonly name: string;
  /** Applies the name; returns the reason if it is refused. */
  readonly take: (name: string) => string | null;
  /** Called after the field was removed. */
  readonly done: () => void;
}

const WIDTH_MIN = 140;
const HEIGHT = 28;

interface RenameField {
  readonly close: () => void;
  /** Shows a change of the name by another user. From then on only Enter applies the text of the field. */
  readonly warn: (text: string) => void;
}

/** Opens the field. Enter and loss of focus apply the name; Escape discards it. */
export function renameField(renaming: Renaming): RenameField {
  const { place, box, name } = renaming;
  const field = document.createElement("input");
  const reason = document.createElement("div");
  field.value = name;
  field.setAttribute("aria-label", `Name of ${name}`);
  field.spellcheck = false;
  const width = Math.max(WIDTH_MIN, Math.min(box.width, 360));
  const left = box.x + (box.width - width) / 2;
  const top = box.y + Math.max(0, (box.height - HEIGHT) / 2);
  field.style.cssText = style(left, top, width);
  reason.setAttribute("role", "alert");
  reason.style.cssText = `${reasonStyle(left, top, width)};display:none`;
  place.append(field, reason);
  let isOpen = true;
  let isWarned = false;
  const say = (text: string) => {
    reason.textContent = text;
    reason.style.display = "";
  };
  const close = () => {
    if (!isOpen) return;
    isOpen = false;
    field.remove();
    reason.remove();
    renaming.done();
  };
  const take = () => {
    const refused = field.value === name ? null : renaming.take(field.value);
    if (refused === null) {
      close();
      return;
    }
    say(refused);
    field.setAttribute("aria-invalid", "true");
  };
  field.addEventListener("keydown", (event) => {
    event.stopPropagation();
    if (event.key === "Enter") take();
    else if (event.key === "Escape") close();
  });
  field.addEventListener("blur", () => {
    if (isOpen && !isWarned) take();
    if (isOpen) close();
  });
  field.focus();
  field.select();
  return {
    close,
    warn: (text) => {
      isWarned = true;
      say(text);
    },
  };
}

function style(left: number, top: number, width: number): string {
  return [
    `position:absolute;left:${left}px;top:${top}px;width:${width}px;height:${HEIGHT}px`,
    "box-sizing:border-box;padding:0 8px;border-radius:6px;font:inherit;text-align:center",
    "background:var(--raised);color:var(--text)",
    "border:1px solid var(--accent);outline:2px solid var(--accent)",
    "z-index:var(--layer-over)",
  ].join(";");
}

function reasonStyle(left: number, top: number, width: number): string {
  return [
    `position:absolute;left:${left}px;top:${top + HEIGHT + 6}px;width:${Math.max(width, 240)}px`,
    "box-sizing:border-box;padding:6px 8px;border-radius:6px;font:inherit",
    "background:var(--raised);color:var(--danger)",
    "border:1px solid var(--danger);z-index:var(--layer-over)",
  ].join(";");
}
