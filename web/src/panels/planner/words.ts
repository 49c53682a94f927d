/** Texts about the results of a planner. */

import type { PlanFound } from "../../model/generated/protocol.ts";
import { inPageWords } from "../../model/page_words.ts";
import type { Planning } from "../../store/planner/planner.ts";

/** Progress or result of planning; empty if there is none to report. */
export function planningInWords(planning: Planning, now_ms: number): string {
  switch (planning.state) {
    case "idle":
    case "done":
      return "";
    case "planning":
      return `Planning… ${Math.max(0, Math.floor((now_ms - planning.since_ms) / 1_000))} s`;
    case "refused":
      return "Skills, facts and goal do not fit: see what is wrong above.";
    case "unasked":
      return sentence(planning.reason);
    case "cancelled":
      return `Cancelled after ${seconds(planning.end.after_ms)}.`;
    case "impossible":
      return sentence(`there is no plan: ${planning.end.reason}`);
    case "not_found":
    case "failed":
      return sentence(planning.end.reason);
  }
}

function sentence(message: string): string {
  const text = inPageWords(message);
  const end = /[.!?]$/.test(text) ? "" : ".";
  return text.charAt(0).toUpperCase() + text.slice(1) + end;
}

export function foundInWords(found: PlanFound): string {
  const { steps, engine, after_ms, cost, temporal, makespan, lost } = found;
  const many = steps.length === 1 ? "1 step" : `${steps.length} steps`;
  const parts = [`${many} in ${seconds(after_ms)} by ${engine}`];
  if (cost !== undefined) parts.push(`cost ${short(cost)}`);
  if (temporal) parts.push(`takes ${short(makespan)}`);
  if (lost > 0) parts.push(`its machine ${short(lost)} longer, as what runs together waits`);
  return parts.join(", ");
}

export function seconds(ms: number): string {
  return ms < 1_000 ? `${Math.round(ms)} ms` : `${(ms / 1_000).toFixed(1)} s`;
}

export function short(value: number): string {
  return String(Math.round(value * 1_000) / 1_000);
}
