/** The graph for screen readers: a hidden tree of the current level that mirrors the selection. Large levels are cut to the part
 * around the selection. */

import { type ElementRef, keyOf } from "../../model/element.ts";
import type { Machine } from "../../model/machine.ts";
import { parentOf } from "../../model/path.ts";
import type { Layout } from "../layout/layout.ts";
import { described, type Signs } from "./describe.ts";

export interface TreeLine {
  readonly element: ElementRef;
  readonly text: string;
  readonly level: 1 | 2 | 3;
  readonly selected: boolean;
  /** Position among its siblings, counted from 1, and their number. */
  readonly number: number;
  readonly count: number;
}

const AROUND_MAX = 40;

/** Tree of a level: the container, its children near the selection, and the selected part of one of them. */
export function treeLines(
  machine: Machine,
  layout: Layout,
  workingContainer: string,
  selection: readonly ElementRef[],
  signsOf: (path: string) => Signs,
): readonly TreeLine[] {
  const active = selection.at(-1);
  const container = levelOf(layout, workingContainer, active);
  const chosen = new Set(selection.map(keyOf));
  const line = (
    element: ElementRef,
    level: 1 | 2 | 3,
    number: number,
    count: number,
  ): TreeLine => ({
    element,
    text: described(machine, element, signsOf(element.path)),
    level,
    selected: chosen.has(keyOf(element)),
    number,
    count,
  });
  const lines = [line({ kind: "state", path: container }, 1, 1, 1)];
  const paths = layout.children(container);
  const at = Math.max(0, active ? paths.indexOf(active.path) : 0);
  const first = Math.max(0, at - AROUND_MAX);
  const part = active && active.kind !== "state" ? active : null;
  if (part && part.path === container) lines.push(line(part, 2, 1, 1));
  paths.slice(first, at + AROUND_MAX).forEach((path, index) => {
    lines.push(line({ kind: "state", path }, 2, first + index + 1, paths.length));
    if (part && part.path === path) lines.push(line(part, 3, 1, 1));
  });
  return lines;
}

/** Container of the selection, or else the one that fills the view. */
function levelOf(layout: Layout, workingContainer: string, active: ElementRef | undefined): string {
  if (!active || !layout.box(active.path)) return workingContainer;
  if (active.kind === "transition" || active.kind === "data_flow") return active.path;
  return parentOf(active.path) ?? active.path;
}

function isSame(lines: readonly TreeLine[], others: readonly TreeLine[]): boolean {
  return (
    lines.length === others.length &&
    lines.every((line, index) => {
      const other = others[index];
      return (
        other?.text === line.text &&
        keyOf(other.element) === keyOf(line.element) &&
        other.selected === line.selected &&
        other.count === line.count &&
        other.number === line.number
      );
    })
  );
}

/** Invisible, but available to screen readers. */
const HIDDEN =
  "position:absolute;width:1px;height:1px;overflow:hidden;clip-path:inset(50%);white-space:nowrap;";

/** Hidden tree in the document. */
export class ReaderTree {
  readonly tree: HTMLElement;
  readonly status: HTMLElement;
  readonly #owner: HTMLElement;
  readonly #name: string;
  #lines: readonly TreeLine[] = [];

  /** `owner` has the focus. Its `aria-activedescendant` names the current line of the tree. */
  constructor(owner: HTMLElement, name: string) {
    this.#owner = owner;
    this.#name = name;
    this.tree = document.createElement("div");
    this.tree.setAttribute("role", "tree");
    this.tree.setAttribute("aria-label", "States of this level");
    this.tree.setAttribute("aria-multiselectable", "true");
    this.tree.style.cssText = HIDDEN;
    this.status = document.createElement("div");
    this.status.setAttribute("role", "status");
    this.status.style.cssText = HIDDEN;
    owner.append(this.tree, this.status);
  }

  show(lines: readonly TreeLine[]): void {
    if (isSame(lines, this.#lines)) return;
    this.#lines = lines;
    const items = lines.map((line, index) => this.#item(line, index));
    this.tree.replaceChildren(...items);
    const active = items[lines.findLastIndex((line) => line.selected)];
    if (active) this.#owner.setAttribute("aria-activedescendant", active.id);
    else this.#owner.removeAttribute("aria-activedescendant");
  }

  #item(line: TreeLine, index: number): HTMLElement {
    const item = document.createElement("div");
    item.id = `${this.#name}-${index}`;
    item.setAttribute("role", "treeitem");
    item.setAttribute("aria-level", String(line.level));
    item.setAttribute("aria-posinset", String(line.number));
    item.setAttribute("aria-setsize", String(line.count));
    item.setAttribute("aria-selected", String(line.selected));
    item.textContent = line.text;
    return item;
  }

  /** Element that an item of the tree represents. */
  elementOf(target: EventTarget | null): ElementRef | null {
    const index = [...this.tree.children].indexOf(target as Element);
    return this.#lines[index]?.element ?? null;
  }

  say(text: string): void {
    if (this.status.textContent !== text) this.status.textContent = text;
  }
}
