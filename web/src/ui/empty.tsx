/** What an empty place says: what would be here, and how to get it. */

import type { ReactNode } from "react";
import { Button } from "./button.tsx";
import "./empty.css";

interface EmptyProps {
  readonly title: string;
  /** How to get it. */
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
