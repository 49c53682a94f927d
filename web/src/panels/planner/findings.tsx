/** Problems of skills, facts or goal, with links to their libraries. */

import { CircleAlert, TriangleAlert } from "lucide-react";
import type { ReactNode } from "react";
import { openLibraryMachine } from "../../commands/library_machine.ts";
import type { PlanFinding } from "../../model/generated/protocol.ts";
import { Button } from "../../ui/button.tsx";
import { useHost } from "../context.tsx";

export function Findings({ findings }: { readonly findings: readonly PlanFinding[] | undefined }) {
  if (!findings || findings.length === 0) return null;
  return (
    <ul className="planner-findings">
      {findings.map(({ is_error, libraries = [], text }) => {
        const Icon = is_error ? CircleAlert : TriangleAlert;
        return (
          <li key={`${libraries.join()} ${text}`} className={is_error ? "is-error" : "is-warning"}>
            <Icon size={14} aria-label={is_error ? "Error" : "Warning"} />
            <span>
              {inWords(text)}
              {libraries.map((path) => (
                <LibraryLink key={path} path={path}>
                  {path}
                </LibraryLink>
              ))}
            </span>
          </li>
        );
      })}
    </ul>
  );
}

/** Formats text in backticks as code. */
function inWords(text: string): readonly ReactNode[] {
  // biome-ignore lint/suspicious/noArrayIndexKey: the parts of a text keep their order
  return text.split("`").map((part, at) => (at % 2 === 1 ? <code key={at}>{part}</code> : part));
}

interface LibraryLinkProps {
  readonly path: string;
  readonly children: ReactNode;
}

/** Opens the machine of a library. */
export function LibraryLink({ path, children }: LibraryLinkProps) {
  const { page } = useHost().context();
  const at = path.lastIndexOf("/");
  const open = () =>
    void openLibraryMachine(page, {
      path: path.slice(0, Math.max(0, at)),
      name: path.slice(at + 1),
    });
  return (
    <Button kind="quiet" className="planner-link" title={`Open ${path}`} onClick={open}>
      {children}
    </Button>
  );
}
