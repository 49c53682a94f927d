/** A dialog over the page: keeps the keyboard, closes with Escape, gives the focus back. */

import { X } from "lucide-react";
import { type ReactNode, useEffect, useId, useRef } from "react";
import { IconButton } from "./button.tsx";
import "./dialog.css";

export interface DialogProps {
  readonly title: string;
  readonly children: ReactNode;
  /** Buttons at its foot, the one that does it last. */
  readonly footer?: ReactNode;
  readonly onClose: () => void;
  /** In CSS pixels. */
  readonly width?: number | undefined;
  readonly height?: number | undefined;
}

/** What has the keyboard first, if nothing asks for it: what is to be filled in, else what is to be pressed. */
const FIRST =
  ".dialog-body :is(input, select, textarea, [tabindex='0']), .dialog-body button, .dialog-foot button:last-child";

export function Dialog({ title, children, footer, onClose, width = 460, height }: DialogProps) {
  const place = useRef<HTMLDialogElement>(null);
  const id = useId();
  useEffect(() => {
    const dialog = place.current;
    if (!dialog) return;
    const before = dialog.ownerDocument.activeElement;
    const wanted = dialog.contains(before) ? before : dialog.querySelector(FIRST);
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
