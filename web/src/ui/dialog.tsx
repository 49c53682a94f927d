/** A dialog over the page: keeps the keyboard, closes with Escape, gives the focus back. */

import { X } from "lucide-react";
import { type ReactNode, useEffect, useId, useRef } from "react";
import { IconButton } from "./button.tsx";
import "./dialog.css";

export interface DialogProps {
  readonly title: string;
  readonly children: ReactNode;
  /** Buttons at its foot: first the one that changes nothing, last the one that does it. */
  readonly footer?: ReactNode;
  readonly onClose: () => void;
  /** In CSS pixels. */
  readonly width?: number | undefined;
  readonly height?: number | undefined;
}

/** Places of the first focus, the first that exists: what the dialog marks as safe, a field, the button that changes nothing. Enter
 * in a question does what is safe. */
const FIRST = [
  "[data-safe]",
  ".dialog-body :is(input, select, textarea, [tabindex='0'])",
  ".dialog-foot button",
  ".dialog-body button",
  ".dialog-head button",
];

export function Dialog({ title, children, footer, onClose, width = 460, height }: DialogProps) {
  const place = useRef<HTMLDialogElement>(null);
  const id = useId();
  useEffect(() => {
    const dialog = place.current;
    if (!dialog) return;
    const before = dialog.ownerDocument.activeElement;
    const first = FIRST.map((place) => dialog.querySelector(place)).find((found) => found !== null);
    const wanted = dialog.contains(before) ? before : first;
    if (!dialog.open) dialog.showModal();
    if (wanted instanceof HTMLElement) wanted.focus();
    if (wanted instanceof HTMLInputElement) wanted.select();
    return () => {
      dialog.close();
      if (before instanceof HTMLElement && before.isConnected) before.focus();
    };
  }, []);
  return (
    <dialog
      ref={place}
      className="dialog"
      aria-labelledby={id}
      style={{ width, ...(height === undefined ? {} : { height }) }}
      onCancel={(event) => {
        event.preventDefault();
        onClose();
      }}
      onKeyDown={(event) => event.stopPropagation()}
    >
      <div className="dialog-head">
        <h2 id={id} className="dialog-title">
          {title}
        </h2>
        <IconButton label="Close" icon={<X size={16} />} onClick={onClose} />
      </div>
      <div className="dialog-body">{children}</div>
      {footer && <div className="dialog-foot">{footer}</div>}
    </dialog>
  );
}
