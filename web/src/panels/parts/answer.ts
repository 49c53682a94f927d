/** Responses to questions of states: initial values, checks, the sent value, and its text. */

import type { Form, JsonValue, Question } from "../../model/generated/protocol.ts";

/** Current content of the form. */
export interface Filled {
  readonly text: string;
  readonly checked: readonly boolean[];
}

export function firstFilled(form: Form): Filled {
  switch (form.type) {
    case "buttons":
      return { text: "", checked: [] };
    case "text":
      return { text: form.initial, checked: [] };
    case "number":
      return { text: form.initial === null ? "" : String(form.initial), checked: [] };
    case "checks":
      return { text: "", checked: form.boxes.map((_, box) => form.initial[box] ?? false) };
  }
}

/** Reason why the content is invalid; null if it is valid. */
export function refusalOfFilled(form: Form, { text }: Filled): string | null {
  if (form.type !== "number") return null;
  const number = numberOf(text);
  if (number === null) return "Enter a number.";
  if (form.whole && !Number.isInteger(number)) return `${number} is not a whole number.`;
  if (form.minimum !== null && number < form.minimum) {
    return `${number} is too small; the minimum is ${form.minimum}.`;
  }
  if (form.maximum !== null && number > form.maximum) {
    return `${number} is too large; the maximum is ${form.maximum}.`;
  }
  return null;
}

/** Response to send when a button is pressed. A cancelled form may be incomplete. */
export function answerOf(form: Form, { text, checked }: Filled, button: number): JsonValue {
  switch (form.type) {
    case "buttons":
      return { button };
    case "text":
      return { button, text };
    case "number":
      return { button, number: numberOf(text) ?? anyNumber(form) };
    case "checks":
      return { button, checked: [...checked] };
  }
}

/** Text of a response: `yes`, `OK: 3.5`, `OK: left, right`. */
export function answerInWords(form: Form, answer: JsonValue | null): string {
  if (typeof answer !== "object" || answer === null || Array.isArray(answer)) return "";
  const button = form.buttons[Number(answer["button"])] ?? "";
  const rest = restInWords(form, answer);
  return rest === "" ? button : `${button}: ${rest}`;
}

/** Effect of the timeout. */
export function deadlineInWords({ form, default: fallback }: Question): string {
  return fallback === null
    ? "then the state fails"
    : `then “${answerInWords(form, fallback)}” is used`;
}

/** Range of a number as text; empty if it has none. */
export function rangeInWords(form: Form): string {
  if (form.type !== "number") return "";
  const { minimum, maximum, whole } = form;
  const kind = whole ? "whole number" : "number";
  if (minimum !== null && maximum !== null) return `${kind} from ${minimum} to ${maximum}`;
  if (minimum !== null) return `${kind} of at least ${minimum}`;
  return maximum === null ? kind : `${kind} of at most ${maximum}`;
}

function restInWords(form: Form, answer: { readonly [key: string]: JsonValue }): string {
  if (form.type === "text") return `“${answer["text"]}”`;
  if (form.type === "number") return String(answer["number"]);
  if (form.type !== "checks") return "";
  const checked = answer["checked"];
  const boxes = form.boxes.filter((_, box) => Array.isArray(checked) && checked[box] === true);
  return boxes.length === 0 ? "none" : boxes.join(", ");
}

function numberOf(text: string): number | null {
  const number = Number(text.trim().replace(",", "."));
  return text.trim() === "" || !Number.isFinite(number) ? null : number;
}

function anyNumber({ initial, minimum, maximum }: Form & { readonly type: "number" }): number {
  const most = maximum ?? Number.POSITIVE_INFINITY;
  return initial ?? Math.max(minimum ?? Number.NEGATIVE_INFINITY, Math.min(most, 0));
}
