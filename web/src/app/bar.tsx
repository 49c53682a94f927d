/** A bar above the canvas: what has to be known now, with the ways out. */

import type { ReactNode } from "react";

interface PageBarProps {
  readonly kind?: "plain" | "warning" | "danger";
  readonly icon: ReactNode;
  readonly children: ReactNode;
  readonly actions?: ReactNode;
}

export function Bar({ kind = "plain", icon, children, actions }: PageBarProps) {
  return (
    <div className={`bar bar-${kind}`} role="status">
      {icon}
      <span className="bar-text">{children}</span>
      {actions}
    </div>
  );
}
