/** What every part of the inspector is given: the machine that is looked at, and the way of edits to it. */

import type { ElementRef } from "../../model/element.ts";
import type { StateDocument } from "../../model/generated/protocol.ts";
import type { Machine } from "../../model/machine.ts";
import { isRefused, type Planned } from "../../plan/plan.ts";
import { wasRefused } from "../../store/document/machine_session.ts";
import type { OpenTab, Page } from "../../store/page/page.ts";
import { mayEdit, whyFixed } from "../../store/page/rights.ts";

/** What becomes of an edit: refused at once, or what the server answers. Null is well. */
export type Made = string | Promise<string | null>;

/** A machine in the inspector. */
export interface InspectorContext {
  readonly page: Page;
  readonly tab: OpenTab;
  readonly machine: Machine;
  /** Makes an edit: null, or why it was refused, which is shown where it was asked for. */
  readonly edit: (plan: (machine: Machine) => Planned) => Made;
  /** Selects an element and brings it into sight. */
  readonly show: (element: ElementRef) => void;
  readonly hover: (element: ElementRef | null) => void;
  readonly run: (command: string, argument?: unknown) => void;
}

/** A state in the inspector. */
export interface InspectedState extends InspectorContext {
  readonly path: string;
  readonly state: StateDocument;
  /** Whether nothing of it may be changed here. */
  readonly readOnly: boolean;
}

/** Makes an edit: null, or why it was refused. */
export function makeEdit(page: Page, tab: OpenTab, plan: (machine: Machine) => Planned): Made {
  const why = whyFixed(page, tab);
  if (why !== null) return why;
  const planned = plan(tab.session.machine);
  if (isRefused(planned)) return tab.session.named(planned.refused);
  return tab.session
    .edit(planned.name, planned.edit)
    .then((answer) => (wasRefused(answer) ? tab.session.named(answer.refused) : null));
}

export function inspectedState(context: InspectorContext, path: string): InspectedState | null {
  const state = context.machine.state(path);
  if (!state) return null;
  const isFixed = context.tab.session.fixed !== null || !mayEdit(context.page);
  return { ...context, path, state, readOnly: isFixed || context.machine.isInLibrary(path) };
}
