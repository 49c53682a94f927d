/** The buttons at the end of a row: shows its element on the canvas, and removes it. */

import { Crosshair, Trash2 } from "lucide-react";
import { IconButton } from "../../ui/button.tsx";

interface RowButtonsProps {
  /** What the row is about: "input speed". */
  readonly what: string;
  readonly onShow: () => void;
  /** Left out: it cannot be removed. */
  readonly onRemove?: (() => void) | undefined;
}

/** Of the column in which they stand. */
export const ROW_BUTTONS_WIDTH = "calc(2 * var(--row) + 10px)";

export function RowButtons({ what, onShow, onRemove }: RowButtonsProps) {
  return (
    <span className="inspector-row-buttons">
      <IconButton
        className="inspector-mini"
        label={`Show ${what} on the canvas`}
        icon={<Crosshair size={13} />}
        onClick={onShow}
      />
      {onRemove && (
        <IconButton
          className="inspector-mini"
          label={`Remove ${what}`}
          icon={<Trash2 size={13} />}
          onClick={onRemove}
        />
      )}
    </span>
  );
}
