/** Parts and functions of values, for expressions. Data that was not kept is reported as missing, never guessed. */

import type { JsonValue } from "./generated/protocol.ts";
import { numbersOf } from "./numbers.ts";
import { keyLabel, type ReadArray, read, typeWords } from "./wire.ts";

/** Reason why a value cannot be computed, in words for people. */
export class WrongValue extends Error {}

export const FUNCTIONS: readonly string[] = ["len", "abs", "min", "max", "sum", "mean", "round"];

/** Converts a value to a number. Throws a `WrongValue` for other types. */
export function numberIn(value: JsonValue): number {
  const found = read(value);
  if (found.kind === "number") return found.value;
  if (found.kind === "bool") return Number(found.value);
  if (found.kind === "array" && found.items?.length === 1) return found.items[0] ?? Number.NaN;
  throw new WrongValue(`${typeWords(found)} is not a number`);
}

/** True if the value is true in Python. */
export function isTrue(value: JsonValue): boolean {
  const found = read(value);
  switch (found.kind) {
    case "none":
      return false;
    case "bool":
      return found.value;
    case "number":
      return found.value !== 0;
    case "text":
    case "list":
    case "dict":
      return found.count > 0;
    default:
      return true;
  }
}

/** `value.x`: an entry of a dict, or an attribute of an array or error. */
export function memberOf(value: JsonValue, name: string): JsonValue {
  const found = read(value);
  if (found.kind === "dict") return partOf(value, name);
  if (found.kind === "array" && name === "shape") return { __tuple__: [...found.shape] };
  if (found.kind === "array" && name === "dtype") return found.dtype;
  if (found.kind === "error" && name === "message") return found.message;
  if (found.kind === "object") throw new WrongValue(`only the text of ${found.of} was kept`);
  throw new WrongValue(`${typeWords(found)} has no ${name}`);
}

/** `value[key]`. */
export function partOf(value: JsonValue, key: JsonValue): JsonValue {
  const found = read(value);
  switch (found.kind) {
    case "dict": {
      const label = found.hasLiteralKeys ? keyLabel(key) : String(key);
      const entry = found.entries.find(([name]) => name === label);
      if (entry) return entry[1];
      const isCut = found.count > found.entries.length;
      throw new WrongValue(isCut ? `"${label}" was not kept` : `there is no "${label}"`);
    }
    case "list": {
      const index = indexIn(key, found.count);
      const item = found.items[index];
      if (item === undefined) throw new WrongValue(`[${index}] was not kept`);
      return item;
    }
    case "text":
      return [...found.text][indexIn(key, found.count)] ?? "";
    case "array":
      return rowOf(found, key);
    default:
      throw new WrongValue(`${typeWords(found)} has no parts`);
  }
}

function indexIn(key: JsonValue, count: number): number {
  const position = numberIn(key);
  const index = position < 0 ? position + count : position;
  if (!Number.isInteger(index)) throw new WrongValue(`${position} is not an index`);
  if (index < 0 || index >= count)
    throw new WrongValue(`[${position}] is out of range: the length is ${count}`);
  return index;
}

/** A number of an array, or the rest of an array with more axes. */
function rowOf(array: ReadArray, key: JsonValue): JsonValue {
  const { items, shape, sampled, steps } = array;
  const [count = 0, ...inner] = shape;
  if (!items || shape.length === 0) throw new WrongValue("no numbers of this array were kept");
  const index = indexIn(key, count);
  const step = steps[0] ?? 1;
  if (index % step !== 0) throw new WrongValue(`[${index}] was not kept: only one in ${step} was`);
  const size = sampled.slice(1).reduce((all, each) => all * each, 1);
  const row = items.slice((index / step) * size, (index / step + 1) * size);
  if (inner.length === 0) return row[0] ?? null;
  return {
    __repr__: "",
    __class__: array.of,
    __dtype__: array.dtype,
    __shape__: inner,
    __items__: [...row],
    __sampled__: sampled.slice(1),
    __steps__: steps.slice(1),
  };
}

export function callFunction(name: string, values: readonly JsonValue[]): JsonValue {
  const [first = null] = values;
  switch (name) {
    case "len":
      return lengthOf(first);
    case "abs":
      return Math.abs(numberIn(first));
    case "round": {
      const power = 10 ** numberIn(values[1] ?? 0);
      return Math.round(numberIn(first) * power) / power;
    }
    default:
      return overAll(name, values.length > 1 ? values.map(numberIn) : allIn(first));
  }
}

function lengthOf(value: JsonValue): number {
  const found = read(value);
  if (found.kind === "array" && found.shape.length > 0) return found.shape[0] ?? 0;
  if (found.kind === "text" || found.kind === "list" || found.kind === "dict") return found.count;
  throw new WrongValue(`${typeWords(found)} has no length`);
}

function overAll(name: string, numbers: readonly number[]): number {
  if (numbers.length === 0 && name !== "sum")
    throw new WrongValue(`${name} needs at least one number`);
  const sum = numbers.reduce((all, each) => all + each, 0);
  switch (name) {
    case "min":
      return Math.min(...numbers);
    case "max":
      return Math.max(...numbers);
    case "mean":
      return sum / numbers.length;
    default:
      return sum;
  }
}

/** All numbers of a list or array. Throws a `WrongValue` if only a part of them was kept. */
function allIn(value: JsonValue): readonly number[] {
  const found = read(value);
  const isCut =
    found.kind === "array"
      ? found.steps.some((step) => step > 1)
      : found.kind === "list" && found.count > found.items.length;
  if (isCut) throw new WrongValue("not all of its numbers were kept");
  if (found.kind === "list" && found.items.length < 2) return found.items.map(numberIn);
  if (found.kind === "array" && found.items) return found.items;
  const numbers = numbersOf(found);
  if (!numbers) throw new WrongValue(`${typeWords(found)} is not a list of numbers`);
  return numbers.items;
}
