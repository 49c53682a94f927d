/** Position of a state in its container, its size, and its colour. */

import { useState } from "react";
import type { Box } from "../../model/geometry.ts";
import { readLayout } from "../../model/layout_reader.ts";
import { parentOf } from "../../model/path.ts";
import { boxIn } from "../../plan/boxes.ts";
import { setBackground, setSide } from "../../plan/move.ts";
import { refused } from "../../plan/plan.ts";
import { Checkbox, TextField } from "../../ui/field.tsx";
import { Colour } from "./colour.tsx";
import { Fold } from "./fold.tsx";
import type { InspectedState } from "./inspector_context.ts";
import { Refusal, useRefusal } from "./refusal.tsx";

export function Place({ inspected }: { inspected: InspectedState }) {
  const { path, state, machine, readOnly, edit } = inspected;
  const [refusal, run] = useRefusal();
  const [withContent, setWithContent] = useState(false);
  const box = boxIn(machine, path);
  const isRoot = parentOf(path) === null;
  const put = (side: keyof Box) => (text: string) =>
    edit((now) => {
      const value = Number(text);
      if (!Number.isFinite(value)) return refused(`${text} is not a number.`);
      return setSide(now, path, { side, value }, withContent);
    });
  const field = (side: keyof Box, label: string) => (
    <TextField
      key={`${side} ${path}`}
      label={label}
      type="number"
      value={String(rounded(box[side]))}
      readOnly={readOnly}
      onCommit={put(side)}
    />
  );
  return (
    <Fold title="Size and position" openAtFirst={false}>
      <div className="inspector-grid">
        {!isRoot && field("x", "x")}
        {!isRoot && field("y", "y")}
        {field("width", "Width")}
        {field("height", "Height")}
      </div>
      {!readOnly && (
        <Checkbox label="Scale content on resize" checked={withContent} onChange={setWithContent} />
      )}
      <Colour
        key={`colour ${path}`}
        label="Background colour"
        value={readLayout(state).background ?? null}
        disabled={readOnly}
        onChange={(rgb) => run(edit((now) => setBackground(now, path, rgb)))}
      />
      <Refusal text={refusal} />
    </Fold>
  );
}

function rounded(value: number): number {
  return Math.round(value * 100) / 100;
}
