/** Keys of a search field above a tree. */

import type { KeyboardEvent } from "react";

/** ↓ enters the tree, Enter takes what is found. */
export function keysAboveTree(event: KeyboardEvent<HTMLElement>, take: () => void): void {
  if (event.key === "Enter") take();
  const tree = event.currentTarget.closest(".form")?.querySelector<HTMLElement>("[role=tree]");
  if (event.key !== "ArrowDown" || !tree) return;
  event.preventDefault();
  tree.focus();
}
