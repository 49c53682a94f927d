/** Marks on the browser's own time line, for benches and for whoever looks at a trace. Only the last one is kept. */

export const PICTURE_MARK = "rafcon picture";

/** This version of the machine is on the canvas now. */
export function markPicture(version: number): void {
  performance.clearMarks(PICTURE_MARK);
  performance.mark(PICTURE_MARK, { detail: version });
}
