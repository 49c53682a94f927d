/** What the inspector is about: what is selected, as far as it is still there. */

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

/** What these elements come to; those that are gone do not count. The income is part of its state. */
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

/** The state that has the subject. */
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
