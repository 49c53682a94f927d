/** Field for an optional colour. */

import { X } from "lucide-react";
import { useEffect, useId, useRef } from "react";
import { IconButton } from "../../ui/button.tsx";

export type Bytes = readonly [number, number, number];

interface ColourProps {
  readonly label: string;
  /** Colour as in the layout, such as `rgb(20 40 60)`; null for none. */
  readonly value: string | null;
  readonly disabled?: boolean | undefined;
  readonly onChange: (colour: Bytes | null) => void;
}

export function Colour({ label, value, disabled, onChange }: ColourProps) {
  const id = useId();
  const input = useRef<HTMLInputElement>(null);
  const latest = useRef(onChange);
  latest.current = onChange;
  const hex = value === null ? null : hexOf(value);
  // React calls onChange during the selection of a colour; the native event is sent once, at its end.
  useEffect(() => {
    const field = input.current;
    const chosen = () => field && latest.current(bytesOf(field.value));
    field?.addEventListener("change", chosen);
    return () => field?.removeEventListener("change", chosen);
  }, []);
  useEffect(() => {
    if (input.current) input.current.value = hex ?? NO_COLOUR;
  }, [hex]);
  return (
    <div className="inspector-colour">
      <label className="field-label" htmlFor={id}>
        {label}
      </label>
      <input
        ref={input}
        id={id}
        type="color"
        defaultValue={hex ?? NO_COLOUR}
        disabled={disabled}
        data-none={hex === null}
      />
      <span className="inspector-faint">{hex ?? "from the theme"}</span>
      {hex !== null && !disabled && (
        <IconButton
          className="inspector-mini"
          label="Remove the colour"
          icon={<X size={13} />}
          onClick={() => onChange(null)}
        />
      )}
    </div>
  );
}

const NO_COLOUR = "#808080";

/** Converts `rgb(20 40 60)` to `#14283c`. */
function hexOf(colour: string): string | null {
  const parts = colour.match(/\d+/g)?.slice(0, 3);
  if (parts?.length !== 3) return null;
  return `#${parts.map((part) => Number(part).toString(16).padStart(2, "0")).join("")}`;
}

function bytesOf(hex: string): Bytes {
  const at = (start: number) => Number.parseInt(hex.slice(start, start + 2), 16);
  return [at(1), at(3), at(5)];
}
