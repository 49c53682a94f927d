/** Subject of the inspector: the selected elements that still exist. */

import type { ElementRef } from "../../model/element.ts";
import { type ConnectionRef, type DataPort, isConnection, isPort } from "../../model/ends.ts";
import type { Machine } from "../../model/machine.ts";
import { isThere } from "../../store/page/selection.ts";

export type Subject =
  | { readonly kind: "machine" }
  | { readonly kind: "state"; readonly path: string }
  | { readonly kind: "port"; readonly port: DataPort }
  | { readonly kind: "outcome"; readonly path: string; readonly id: number }
  | { readonly kind: "connection"; readonly connection: ConnectionRef }
  | { readonly kind: "several"; readonly elements: readonly ElementRef[] };

/** Subject for these elements. Deleted ones are ignored; the income counts as its state. */
export function subjectOf(machine: Machine, elements: readonly ElementRef[]): Subject {
  const there = elements.filter((element) => isThere(machine, element));
  const [only] = there;
  if (only === undefined) return { kind: "machine" };
  if (there.length > 1) return { kind: "several", elements: there };
  if (isPort(only)) return { kind: "port", port: only };
  if (isConnection(only)) return { kind: "connection", connection: only };
  if (only.kind === "outcome") return { kind: "outcome", path: only.path, id: only.id };
  return { kind: "state", path: only.path };
}

/** State that the subject belongs to. */
export function pathOf(machine: Machine, subject: Subject): string {
  switch (subject.kind) {
    case "machine":
      return machine.root;
    case "state":
    case "outcome":
      return subject.path;
    case "port":
      return subject.port.path;
    case "connection":
      return subject.connection.path;
    case "several":
      return subject.elements[0]?.path ?? machine.root;
  }
}
