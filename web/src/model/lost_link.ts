/** Policies of a state for the loss of the ground, in its semantic data (`docs/semantics.md`, Lost link). */

import type { JsonValue, Loss } from "./generated/protocol.ts";
import type { Machine } from "./machine.ts";
import { parentOf } from "./path.ts";
import { type Semantic, valueAt, withoutKey, withValue } from "./semantic.ts";

/** Kinds of loss: no messages from the ground, and no commands. */
export const LOSSES: readonly Loss[] = ["link", "command"];

/** Measures of a policy, each after a number of seconds, in order of execution. */
export const MEASURES = ["finish_s", "hold_s", "recover_s"] as const;
export type LossMeasure = (typeof MEASURES)[number];

/** Seconds until each measure. Without any, the state continues, whatever policy an outer state has. */
export type LossPolicy = Readonly<Partial<Record<LossMeasure, number>>>;

const KEYS: Readonly<Record<Loss, string>> = { link: "lost_link", command: "lost_command" };
const YEAR_S = 365 * 86_400;

/** Own policy of a state; null if it has none, "unclear" if it is not understood. */
export function ownPolicy(data: Semantic, loss: Loss): LossPolicy | "unclear" | null {
  const value = valueAt(data, [KEYS[loss]]);
  if (value === undefined) return null;
  if (typeof value === "string" && value.trim() === "continue") return {};
  if (value === null || typeof value !== "object" || Array.isArray(value)) return "unclear";
  const entries = Object.entries(value);
  const read = entries.map(([key, entry]) => [key, secondsOf(entry ?? null)] as const);
  const isClear = read.every(([key, seconds]) => isMeasure(key) && seconds !== null);
  return isClear && read.length > 0 ? Object.fromEntries(read) : "unclear";
}

/** Policy in effect for a state without its own one, and its owner; null if no outer state has one. */
export function policyAround(
  machine: Machine,
  path: string,
  loss: Loss,
): { readonly path: string; readonly policy: LossPolicy } | null {
  for (let outer = parentOf(path); outer !== null; outer = parentOf(outer)) {
    const policy = ownPolicy(machine.state(outer)?.semantic_data, loss);
    if (policy !== null && policy !== "unclear") return { path: outer, policy };
  }
  return null;
}

/** The semantic data with this policy; null removes the state's own one. */
export function withPolicy(data: Semantic, loss: Loss, policy: LossPolicy | null): JsonValue {
  const keys = [KEYS[loss]];
  if (policy === null) return withoutKey(data, keys);
  const entries = MEASURES.flatMap((measure) => {
    const seconds = policy[measure];
    return seconds === undefined ? [] : [[measure, seconds] as const];
  });
  return withValue(data, keys, entries.length === 0 ? "continue" : Object.fromEntries(entries));
}

/** Seconds in the format's notation: a number between 0 and a year, or a text with one; null for anything else. */
export function secondsOf(value: JsonValue): number | null {
  const isText = typeof value === "string" && value.trim() !== "";
  const seconds = isText ? Number(value) : value;
  return typeof seconds === "number" && seconds >= 0 && seconds <= YEAR_S ? seconds : null;
}

/** `finish and pause after 30 s, recover after 600 s`. */
export function policyInWords(policy: LossPolicy): string {
  const words = MEASURES.flatMap((measure) => {
    const seconds = policy[measure];
    return seconds === undefined ? [] : [`${MEASURE_WORDS[measure]} after ${seconds} s`];
  });
  return words.length === 0 ? "continue" : words.join(", ");
}

const MEASURE_WORDS: Readonly<Record<LossMeasure, string>> = {
  finish_s: "finish and pause",
  hold_s: "pause",
  recover_s: "recover",
};

function isMeasure(key: string): key is LossMeasure {
  return MEASURES.some((measure) => measure === key);
}
