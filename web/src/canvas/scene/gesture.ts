/** Preview of a gesture: guides, the rubber band, the line that is drawn, the future boxes, and the reason of a refusal. */

import { elementOf } from "../../model/element.ts";
import type { Box, Point } from "../../model/geometry.ts";
import { screenBox, screenFromWorld } from "../camera/camera.ts";
import type { SceneBuilder } from "./builder.ts";
import { TEXT } from "./detail.ts";
import type { BoxMark, Layer, LineMark } from "./list.ts";
import { wrapped } from "./words.ts";

export function gestureMarks(builder: SceneBuilder): void {
  const { overlay, camera } = builder.input;
  const layer = builder.top();
  for (const { from, to } of overlay.guides) {
    layer.lines.push(line(builder, "guide", [from, to], "guide", 1, true));
  }
  for (const ghost of overlay.ghosts) {
    layer.boxes.push({
      ...outline(screenBox(camera, ghost), "ghost", "selection", true),
      fill: "ghost",
    });
  }
  for (const [key, legal] of overlay.targets) stateTarget(builder, layer, key, legal);
  if (overlay.drop !== null) dropMarks(builder, layer, overlay.drop);
  if (overlay.band) {
    layer.boxes.push({
      ...outline(screenBox(camera, overlay.band), "band", "selection", true),
      fill: "band",
      radius: 0,
    });
  }
  if (overlay.line) {
    const { from, to, through, data, legal } = overlay.line;
    const ink = legal === false ? "illegal" : legal ? "legal" : data ? "data" : "line";
    layer.lines.push({
      ...line(builder, "line", [from, ...through, to], ink, 2, legal === false),
      arrow: 9,
    });
  }
  if (overlay.message) messageMarks(builder, layer);
}

function line(
  { input }: SceneBuilder,
  what: string,
  points: readonly Point[],
  ink: string,
  width: number,
  dash: boolean,
): LineMark {
  const flat = points.flatMap((point) => {
    const { x, y } = screenFromWorld(input.camera, point);
    return [x, y];
  });
  return { what, points: flat, ink, width, radius: 0, curve: false, arrow: 0, dash, alpha: 1 };
}

function outline(box: Box, what: string, ink: string, dash: boolean): BoxMark {
  return { ...box, what, radius: 4, fill: null, stroke: ink, line: 1.5, dash, alpha: 1 };
}

/** Marks a state where a connection may end. Ports are marked where they are drawn. */
function stateTarget(builder: SceneBuilder, layer: Layer, key: string, legal: boolean): void {
  const element = elementOf(key);
  if (element?.kind !== "state") return;
  const box = builder.input.layout.box(element.path);
  if (!box) return;
  const ink = legal ? "legal" : "illegal";
  layer.boxes.push(outline(screenBox(builder.input.camera, box), `${key} target`, ink, !legal));
}

/** Marks the container or transition that would accept the drop. */
function dropMarks(builder: SceneBuilder, layer: Layer, key: string): void {
  const element = elementOf(key);
  const frame = element && builder.input.layout.frame(element.path);
  if (!element || !frame) return;
  if (element.kind === "state") {
    const box = builder.input.layout.box(element.path);
    if (!box) return;
    const mark = outline(screenBox(builder.input.camera, box), `${key} drop`, "legal", false);
    layer.boxes.push({ ...mark, fill: "drop", line: 2 });
    return;
  }
  const found = frame.at.lines.find((each) => each.key === key);
  if (!found) return;
  const points = found.points.map(({ x, y }) => ({
    x: frame.x + x * frame.unit,
    y: frame.y + y * frame.unit,
  }));
  layer.lines.push({ ...line(builder, `${key} drop`, points, "legal", 4, false), radius: 6 });
}

const MESSAGE = { width: 360, rows: 4, pitch: 17, inset: 8 };

/** Message at the pointer, on an opaque plate. */
function messageMarks(builder: SceneBuilder, layer: Layer): void {
  const { overlay, measure } = builder.input;
  if (!overlay.message) return;
  const { at, text, bad } = overlay.message;
  const { rows, pitch, inset } = MESSAGE;
  const lines = wrapped(text, MESSAGE.width, rows, TEXT.usual, measure);
  const width = Math.max(...lines.map((each) => measure(each, TEXT.usual, false))) + 2 * inset;
  const height = lines.length * pitch + inset;
  const x = Math.max(4, Math.min(at.x + 16, builder.width - width - 4));
  const y = Math.max(4, Math.min(at.y + 16, builder.height - height - 4));
  const plate = bad ? "bad" : "good";
  layer.boxes.push({
    what: "message plate",
    ...{ x, y, width, height, radius: 5, fill: plate, dash: false, alpha: 1 },
    stroke: bad ? "illegal" : "outline",
    line: 1,
  });
  lines.forEach((each, index) => {
    layer.texts.push({
      what: "message",
      x: x + inset,
      y: y + inset / 2 + (index + 0.5) * pitch,
      text: each,
      size: TEXT.usual,
      bold: false,
      ink: bad ? "on-bad" : "on-good",
      align: "left",
      alpha: 1,
      plate,
      width: measure(each, TEXT.usual, false),
    });
  });
}
