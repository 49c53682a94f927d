/** Context of all parts of the inspector: the machine, and functions that edit it. */

import type { ElementRef } from "../../model/element.ts";
import type { StateDocument } from "../../model/generated/protocol.ts";
import type { Machine } from "../../model/machine.ts";
import type { Planned } from "../../plan/plan.ts";
import { applyPlan, type Made } from "../../store/page/apply_plan.ts";
import type { OpenTab, Page } from "../../store/page/page.ts";
import { mayEdit } from "../../store/page/rights.ts";
import type { RunCommand } from "../context.tsx";

/** A machine in the inspector. */
export interface InspectorContext {
  readonly page: Page;
  readonly tab: OpenTab;
  readonly machine: Machine;
  /** Applies an edit. Returns null, or the reason of a refusal for display beside the field. */
  readonly edit: (plan: (machine: Machine) => Planned) => Made;
  /** Selects an element, and moves it into view. */
  readonly show: (element: ElementRef) => void;
  readonly hover: (element: ElementRef | null) => void;
  readonly run: RunCommand;
}

/** A state in the inspector. */
export interface InspectedState extends InspectorContext {
  readonly path: string;
  readonly state: StateDocument;
  /** True if the state cannot be edited here. */
  readonly readOnly: boolean;
}

/** Applies an edit; returns null, or the reason of a refusal. The inspector keeps showing its element. */
export function makeEdit(page: Page, tab: OpenTab, plan: (machine: Machine) => Planned): Made {
  return applyPlan(page, tab, plan(tab.session.machine), "keep");
}

export function inspectedState(context: InspectorContext, path: string): InspectedState | null {
  const state = context.machine.state(path);
  if (!state) return null;
  const isFixed = context.tab.session.fixed !== null || !mayEdit(context.page);
  return { ...context, path, state, readOnly: isFixed || context.machine.isInLibrary(path) };
}
