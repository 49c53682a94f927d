/** Python code that recreates a value of a run, as far as it was kept. */

import { type Read, type ReadArray, read } from "./wire.ts";

/** Parts that were not kept become `...`. A value without a literal becomes a constructor call or its printed form. */
export function pythonOf(value: unknown): string {
  const found = read(value);
  switch (found.kind) {
    case "none":
      return "None";
    case "bool":
      return found.value ? "True" : "False";
    case "number":
      return found.of === "int" ? found.text : numberOf(found.value, found.text);
    case "text":
      return textOf(found);
    case "list":
      return listOf(found);
    case "dict":
      return dictOf(found);
    case "array":
      return arrayOf(found);
    case "error":
      return `${found.of}(${found.message === "" ? "" : JSON.stringify(found.message)})`;
    case "type":
      return found.name;
    case "object":
      return found.shown;
  }
}

function numberOf(value: number, text: string): string {
  if (Number.isFinite(value)) return text;
  if (Number.isNaN(value)) return 'float("nan")';
  return value > 0 ? 'float("inf")' : 'float("-inf")';
}

function textOf({ text, count }: Extract<Read, { kind: "text" }>): string {
  const isCut = count > [...text].length;
  return isCut ? `${JSON.stringify(text)}  # ${count} characters` : JSON.stringify(text);
}

function listOf({ of, items, count }: Extract<Read, { kind: "list" }>): string {
  const all = [...items.map(pythonOf), ...(count > items.length ? ["..."] : [])];
  if (of === "list") return `[${all.join(", ")}]`;
  if (of === "tuple") return all.length === 1 ? `(${all[0]},)` : `(${all.join(", ")})`;
  return all.length === 0 ? "set()" : `{${all.join(", ")}}`;
}

function dictOf({ entries, hasLiteralKeys, count }: Extract<Read, { kind: "dict" }>): string {
  const keyOf = (label: string) => (hasLiteralKeys ? label : JSON.stringify(label));
  const all = entries.map(([label, value]) => `${keyOf(label)}: ${pythonOf(value)}`);
  return `{${[...all, ...(count > entries.length ? ["..."] : [])].join(", ")}}`;
}

/** The kept numbers, in the shape of the sample. */
function arrayOf({ items, sampled, shape, steps, dtype, shown }: ReadArray): string {
  if (!items) return shown;
  const inner = numbersOf(nested(items, sampled));
  const isWhole = steps.every((step) => step === 1);
  const note = isWhole ? "" : `  # every ${steps.join(", ")} of ${shape.join(" × ")}`;
  return `numpy.array(${inner}, dtype=${JSON.stringify(dtype)})${note}`;
}

function numbersOf(items: unknown): string {
  if (Array.isArray(items)) return `[${items.map(numbersOf).join(", ")}]`;
  const value = Number(items);
  if (Number.isFinite(value)) return String(value);
  return Number.isNaN(value) ? "numpy.nan" : `${value < 0 ? "-" : ""}numpy.inf`;
}

/** Converts flat numbers, row by row, to nested lists. */
export function nested(items: readonly number[], shape: readonly number[]): unknown {
  const [, ...inner] = shape;
  if (shape.length === 0) return items[0] ?? null;
  if (inner.length === 0) return items;
  const size = inner.reduce((all, each) => all * each, 1);
  return Array.from({ length: shape[0] ?? 0 }, (_, row) =>
    nested(items.slice(row * size, (row + 1) * size), inner),
  );
}
