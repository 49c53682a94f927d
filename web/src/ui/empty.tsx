/** The text of an empty place: its usual content, and the way to add some. */

import type { ReactNode } from "react";
import { Button } from "./button.tsx";
import "./empty.css";

interface EmptyProps {
  readonly title: string;
  /** Instructions for the first content. */
  readonly text?: ReactNode;
  readonly icon?: ReactNode;
  readonly action?: { readonly title: string; readonly onClick: () => void } | undefined;
}

export function Empty({ title, text, icon, action }: EmptyProps) {
  return (
    <div className="empty">
      {icon && <div className="empty-icon">{icon}</div>}
      <div className="empty-title">{title}</div>
      {text && <div>{text}</div>}
      {action && <Button onClick={action.onClick}>{action.title}</Button>}
    </div>
  );
}
