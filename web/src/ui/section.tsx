/** A part of a panel under a heading, which folds. */

import { ChevronRight } from "lucide-react";
import { type ReactNode, useId, useState } from "react";
import "./section.css";

interface SectionProps {
  readonly title: string;
  /** Number of items. */
  readonly count?: number | undefined;
  /** Buttons at the right of the heading. */
  readonly actions?: ReactNode;
  /** Initial state; open by default. */
  readonly defaultOpen?: boolean | undefined;
  /** Controlled state. */
  readonly open?: boolean | undefined;
  readonly onToggle?: ((open: boolean) => void) | undefined;
  readonly children: ReactNode;
}

export function Section({ title, count, actions, children, ...rest }: SectionProps) {
  const [own, setOwn] = useState(rest.defaultOpen ?? true);
  const open = rest.open ?? own;
  const id = useId();
  const toggle = () => {
    setOwn(!open);
    rest.onToggle?.(!open);
  };
  return (
    <section className="section" aria-labelledby={id}>
      <div className="section-head">
        <h3 className="section-title">
          <button
            type="button"
            className="section-fold"
            aria-expanded={open}
            onClick={toggle}
            style={{ width: "100%" }}
          >
            <ChevronRight size={14} aria-hidden />
            <span id={id}>{title}</span>
            {count !== undefined && (
              <span className="section-count">{count.toLocaleString("en")}</span>
            )}
          </button>
        </h3>
        {actions}
      </div>
      {open && <div className="section-body">{children}</div>}
    </section>
  );
}
