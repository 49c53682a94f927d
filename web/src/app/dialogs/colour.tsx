/** Choice of the colour of a state. */

import { useState } from "react";
import type { Rgb } from "../../commands/command.ts";
import { Button } from "../../ui/button.tsx";
import { Dialog } from "../../ui/dialog.tsx";
import type { NamedDialogProps } from "./dialogs.tsx";

/** Calm ones, so that what runs or failed stays the loudest. */
const SWATCHES = [
  "#3b4252",
  "#2f4858",
  "#28504a",
  "#3d5230",
  "#5b4a24",
  "#5c3a2e",
  "#5a2f3c",
  "#4b3560",
  "#2f3f6b",
  "#c9d3e3",
  "#cfe3d4",
  "#efe2c0",
] as const;

export function hexOf(rgb: Rgb): string {
  return `#${rgb
    .map((part) =>
      Math.round(part * 255)
        .toString(16)
        .padStart(2, "0"),
    )
    .join("")}`;
}

function rgbOf(hex: string): Rgb {
  const part = (at: number) => Number.parseInt(hex.slice(at, at + 2), 16) / 255;
  return [part(1), part(3), part(5)];
}

export function Colour({ asks, answer }: NamedDialogProps<"colour">) {
  const [hex, setHex] = useState(asks ? hexOf(asks) : SWATCHES[0]);
  return (
    <Dialog
      title="Background colour"
      width={380}
      onClose={() => answer(null)}
      footer={
        <>
          <Button onClick={() => answer({ rgb: null })}>Default colour</Button>
          <Button kind="primary" onClick={() => answer({ rgb: rgbOf(hex) })}>
            Use {hex}
          </Button>
        </>
      }
    >
      <div className="swatches">
        {SWATCHES.map((swatch) => (
          <button
            key={swatch}
            type="button"
            className="swatch"
            aria-label={`Colour ${swatch}`}
            aria-pressed={hex === swatch}
            style={{ background: swatch }}
            onClick={() => setHex(swatch)}
          />
        ))}
      </div>
      <label className="checkbox">
        <input type="color" value={hex} onChange={(event) => setHex(event.currentTarget.value)} />
        <span>Other colour</span>
      </label>
    </Dialog>
  );
}
