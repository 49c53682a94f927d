/** Which keys do which command: the shipped map, the one for those who come from the reference, and what the user chose. */

import type { Settings } from "../store/page/page.ts";
import type { UserCommand } from "./command.ts";

/** As much of a keyboard event as a key's name needs. */
interface Pressed {
  readonly key: string;
  readonly code: string;
  readonly ctrlKey: boolean;
  readonly metaKey: boolean;
  readonly altKey: boolean;
  readonly shiftKey: boolean;
  readonly getModifierState?: (name: string) => boolean;
}

const NAMES: Readonly<Record<string, string>> = {
  " ": "Space",
  "+": "Plus",
  ArrowUp: "Up",
  ArrowDown: "Down",
  ArrowLeft: "Left",
  ArrowRight: "Right",
  Esc: "Escape",
  Del: "Delete",
};

const MODIFIERS = new Set(["Control", "Shift", "Alt", "Meta", "AltGraph", "CapsLock", "Dead"]);

/** The name of what was pressed: `Ctrl+Shift+Z`, `F2`, `S`, `?`; null of a modifier alone. */
export function keyName(event: Pressed): string | null {
  if (MODIFIERS.has(event.key)) return null;
  // Windows reports AltGr as Ctrl and Alt held together: it types a sign and is none of them.
  const isAltGr = event.getModifierState?.("AltGraph") ?? false;
  const ctrl = !isAltGr && (event.ctrlKey || event.metaKey);
  const alt = !isAltGr && event.altKey;
  const key = isAltGr ? signOf(event.key) : plainKey(event, ctrl || alt);
  const isSign = key.length === 1 && !/[\p{L}\d]/u.test(key);
  const shift = event.shiftKey && !(isSign || key === "Plus");
  return [
    ...(ctrl ? ["Ctrl"] : []),
    ...(shift ? ["Shift"] : []),
    ...(alt ? ["Alt"] : []),
    key,
  ].join("+");
}

/** Letters and digits as on the key, whatever the modifiers make of them and whatever script the layout has. */
function plainKey({ key, code }: Pressed, held: boolean): string {
  if (/^Digit\d$/.test(code) && (held || isForeign(key, /^\p{Nd}$/u))) return code.slice(5);
  if (/^Key[A-Z]$/.test(code) && (held || isForeign(key, /^\p{L}$/u)) && !/^[a-z]$/i.test(key))
    return code.slice(3);
  return signOf(key);
}

function signOf(key: string): string {
  return NAMES[key] ?? (key.length === 1 ? key.toUpperCase() : key);
}

/** Tests a key that types something outside ASCII. */
function isForeign(key: string, wanted: RegExp): boolean {
  return wanted.test(key) && key.charCodeAt(0) > 127;
}

/** The key without modifiers; a letter as on a Latin layout. */
export function latinKey({ key, code }: Pick<Pressed, "key" | "code">): string {
  return isForeign(key, /^\p{L}$/u) && /^Key[A-Z]$/.test(code) ? code.slice(3).toLowerCase() : key;
}

/** Normalises a key of the user: `shift+ctrl+z` is `Ctrl+Shift+Z`; null if it is no key. */
export function readKey(text: string): string | null {
  const parts = text.split("+").map((part) => part.trim());
  const last = parts.pop() ?? "";
  if (last === "") return null;
  const words = parts.map((part) => part.toLowerCase());
  if (words.some((word) => !["ctrl", "shift", "alt"].includes(word))) return null;
  const key =
    last.length === 1 ? last.toUpperCase() : (last[0]?.toUpperCase() ?? "") + last.slice(1);
  const held = [
    ["ctrl", "Ctrl"],
    ["shift", "Shift"],
    ["alt", "Alt"],
  ].flatMap(([word, name]) => (words.includes(word ?? "") && name ? [name] : []));
  return [...held, key].join("+");
}

/** True if the key types or moves in a text, so that it works on the canvas only. */
export function isCanvasKey(key: string): boolean {
  return !key.includes("Ctrl+") && !key.includes("Alt+") && !/^(Shift\+)?F\d+$/.test(key);
}

/** Keys that text fields handle themselves. */
const IN_TEXT = new Set([
  "Ctrl+A",
  "Ctrl+C",
  "Ctrl+V",
  "Ctrl+X",
  "Ctrl+Y",
  "Ctrl+Z",
  "Ctrl+Shift+Z",
  "Ctrl+Left",
  "Ctrl+Right",
  "Ctrl+Delete",
  "Ctrl+Backspace",
  "Ctrl+D",
  "Ctrl+F",
  "Ctrl+G",
  "Ctrl+Shift+G",
  "Ctrl+U",
  "Ctrl+E",
  "Ctrl+Space",
]);

/** True if a focused text field handles the key. */
export function isTextKey(key: string): boolean {
  return isCanvasKey(key) || IN_TEXT.has(key);
}

/** Keys that browsers reserve in windows with tabs. In a window of its own (installed) the page receives them. */
const KEPT_BY_BROWSER = new Set([
  "Ctrl+N",
  "Ctrl+T",
  "Ctrl+W",
  "Ctrl+Shift+N",
  "Ctrl+Shift+T",
  "Ctrl+Shift+W",
  "Ctrl+Tab",
  "Ctrl+Shift+Tab",
  "Ctrl+Q",
]);

export function isKeptByBrowser(key: string): boolean {
  return KEPT_BY_BROWSER.has(key);
}

/** The keys of a command in the maps that ship. */
function shipped(
  command: UserCommand,
  keymap: string,
  taken: ReadonlySet<string>,
): readonly string[] {
  if (keymap !== "classic") return command.keys ?? [];
  return command.classic ?? (command.keys ?? []).filter((key) => !taken.has(key));
}

/** All keys of all commands, as settings have them. */
export function keymap(
  commands: readonly UserCommand[],
  settings: Pick<Settings, "keymap" | "keys">,
): ReadonlyMap<string, readonly string[]> {
  const taken = new Set(commands.flatMap((command) => command.classic ?? []));
  return new Map(
    commands.map((command) => [
      command.id,
      settings.keys[command.id] ?? shipped(command, settings.keymap, taken),
    ]),
  );
}

/** Keys that several commands have, each with the ids. */
export function conflicts(
  map: ReadonlyMap<string, readonly string[]>,
): ReadonlyMap<string, readonly string[]> {
  const users = new Map<string, string[]>();
  for (const [id, keys] of map) {
    for (const key of keys) users.set(key, [...(users.get(key) ?? []), id]);
  }
  return new Map([...users].filter(([, ids]) => ids.length > 1));
}

const SIGNS: Readonly<Record<string, string>> = {
  Plus: "+",
  Up: "↑",
  Down: "↓",
  Left: "←",
  Right: "→",
  Delete: "Del",
  Escape: "Esc",
};

/** A key as menus show it. */
export function shownKey(key: string): string {
  const parts = key.split("+");
  const last = parts.pop() ?? "";
  return [...parts, SIGNS[last] ?? last].join("+");
}

/** Keys that a user wrote into a file; what is no key or no command is left out and named. */
export function readKeys(
  text: string,
  isCommand: (id: string) => boolean,
): { readonly keys: Record<string, string[]>; readonly faults: readonly string[] } {
  const keys: Record<string, string[]> = {};
  const faults: string[] = [];
  const found: unknown = JSON.parse(text);
  const rafcon = typeof found === "object" && found !== null ? Object.entries(found as object) : [];
  for (const [id, bindings] of rafcon) {
    if (!isCommand(id)) faults.push(`there is no command ${id}`);
    else if (!Array.isArray(bindings)) faults.push(`${id}: keys must be a list of texts`);
    else {
      const read = bindings.map((each) => (typeof each === "string" ? readKey(each) : null));
      read.forEach((key, index) => {
        if (key === null) faults.push(`${id}: ${String(bindings[index])} is not a key`);
      });
      keys[id] = read.filter((key) => key !== null);
    }
  }
  return { keys, faults };
}
