/** Buttons at the end of a row: show the element on the canvas, and remove it. */

import { Crosshair, Trash2 } from "lucide-react";
import { IconButton } from "../../ui/button.tsx";

interface RowButtonsProps {
  /** Name of the row's element, such as "input speed". */
  readonly what: string;
  readonly onShow: () => void;
  /** Undefined if the element cannot be removed. */
  readonly onRemove?: (() => void) | undefined;
}

/** Width of the column of buttons. */
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
