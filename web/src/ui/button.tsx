/** Buttons with a label, or with an icon whose name is its accessible name and its tooltip. */

import type { MouseEvent, ReactNode } from "react";
import "./button.css";

interface Common {
  readonly onClick: (event: MouseEvent<HTMLButtonElement>) => void;
  /** It does nothing, and yet has the keyboard: who cannot press it can read why, and who has it does not lose their place. */
  readonly disabled?: boolean | undefined;
  /** State of a toggle button. */
  readonly pressed?: boolean | undefined;
  /** Shortcut for the tooltip. */
  readonly keys?: string | undefined;
  readonly className?: string | undefined;
}

interface ButtonProps extends Common {
  readonly children: ReactNode;
  readonly kind?: "plain" | "primary" | "danger" | "quiet" | undefined;
  readonly icon?: ReactNode;
  /** Description of the action, or the reason why it is disabled. */
  readonly title?: string | undefined;
}

export function Button({
  children,
  kind = "plain",
  icon,
  title,
  keys,
  pressed,
  className = "",
  ...pressing
}: ButtonProps) {
  return (
    <button
      type="button"
      className={`button button-${kind} ${className}`}
      title={tooltip(title, keys)}
      aria-pressed={pressed}
      {...pressable(pressing)}
    >
      {icon}
      {children}
    </button>
  );
}

interface IconButtonProps extends Common {
  /** Accessible name and tooltip. */
  readonly label: string;
  readonly icon: ReactNode;
}

export function IconButton({
  label,
  icon,
  keys,
  pressed,
  className = "",
  ...pressing
}: IconButtonProps) {
  return (
    <button
      type="button"
      className={`icon-button ${className}`}
      aria-label={label}
      aria-pressed={pressed}
      title={tooltip(label, keys)}
      {...pressable(pressing)}
    >
      {icon}
    </button>
  );
}

function pressable({ disabled, onClick }: Pick<Common, "disabled" | "onClick">) {
  return {
    "aria-disabled": disabled || undefined,
    onClick: (event: MouseEvent<HTMLButtonElement>) => {
      if (disabled) event.stopPropagation();
      else onClick(event);
    },
  };
}

function tooltip(text: string | undefined, keys: string | undefined): string | undefined {
  return text && keys ? `${text} (${keys})` : text;
}
