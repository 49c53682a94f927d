/** Dragging a value from its display to the watched values. */

import type { Target } from "../../../store/run/watched_values.ts";

const TYPE = "application/x-rafcon-value";

interface Drag {
  readonly dataTransfer: DataTransfer;
}

export function dragValue({ dataTransfer }: Drag, target: Target): void {
  dataTransfer.effectAllowed = "link";
  dataTransfer.setData(TYPE, JSON.stringify(target));
  dataTransfer.setData("text/plain", target.name);
}

/** True if the dragged object is a value. */
export function isValueDrag({ dataTransfer }: Drag): boolean {
  return dataTransfer.types.includes(TYPE);
}

/** Dropped value; null for other objects. */
export function droppedValue({ dataTransfer }: Drag): Target | null {
  const text = dataTransfer.getData(TYPE);
  return text === "" ? null : (JSON.parse(text) as Target);
}
