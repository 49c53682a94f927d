/** A value that is dragged from where it stands to where it is to be watched. */

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

/** Whether a value is dragged here. */
export function isValueDrag({ dataTransfer }: Drag): boolean {
  return dataTransfer.types.includes(TYPE);
}

/** The value that was dropped; null if it was something else. */
export function droppedValue({ dataTransfer }: Drag): Target | null {
  const text = dataTransfer.getData(TYPE);
  return text === "" ? null : (JSON.parse(text) as Target);
}
