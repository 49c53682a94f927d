/** Pool of skills: the chosen libraries, and the resulting skills. */

import { X } from "lucide-react";
import type {
  LibraryNode,
  LibraryRoot,
  PlanDomain,
  PlanSkill,
} from "../../model/generated/protocol.ts";
import type { Planner } from "../../store/planner/planner.ts";
import { IconButton } from "../../ui/button.tsx";
import { TextField } from "../../ui/field.tsx";
import { Section } from "../../ui/section.tsx";
import { useSignal } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { Findings, LibraryLink } from "./findings.tsx";

export function Skills({ planner }: { readonly planner: Planner }) {
  const { page } = useHost().context();
  const { libraries, types } = useSignal(planner.inputs);
  const domain = useSignal(planner.domain);
  const fault = useSignal(planner.domainFault);
  const roots = useSignal(page.libraries);
  const add = (text: string) => {
    const path = text.trim().replaceAll(/^\/+|\/+$/g, "");
    if (path !== "" && !libraries.includes(path))
      planner.change({ libraries: [...libraries, path] });
  };
  const remove = (path: string) =>
    planner.change({ libraries: libraries.filter((each) => each !== path) });
  return (
    <Section title="Skills" count={domain?.skills.length}>
      <div className="planner-fields">
        {libraries.length > 0 && (
          <ul className="planner-chips" aria-label="Libraries with skills">
            {libraries.map((path) => (
              <li key={path} className="planner-chip">
                <span title={path}>{path}</span>
                <IconButton
                  label={`Remove ${path}`}
                  icon={<X size={12} />}
                  onClick={() => remove(path)}
                />
              </li>
            ))}
          </ul>
        )}
        <TextField
          key={libraries.join("\n")}
          label="Add libraries"
          hideLabel={libraries.length > 0}
          placeholder="Library root, folder or library"
          value=""
          suggestions={pathsIn(roots).filter((path) => !libraries.includes(path))}
          onCommit={add}
        />
        {fault !== null && <p className="planner-fault">{fault}</p>}
        {domain && <Domain domain={domain} />}
        <details className="planner-more" open={types !== ""}>
          <summary>Kinds of types</summary>
          <TextField
            label="Kinds of types"
            hideLabel
            mono
            placeholder="cup plate - dish"
            hint="Types that are kinds of another type, as in PDDL."
            value={types}
            onCommit={(text) => planner.change({ types: text })}
          />
        </details>
      </div>
    </Section>
  );
}

const PATHS_MAX = 500;

/** Paths of library roots, and of the folders and libraries in them. */
function pathsIn(roots: readonly LibraryRoot[]): readonly string[] {
  const inside = (path: string, nodes: readonly LibraryNode[]): readonly string[] =>
    nodes.flatMap(({ name, children }) => [
      `${path}/${name}`,
      ...inside(`${path}/${name}`, children ?? []),
    ]);
  return roots
    .flatMap(({ name, children }) => [name, ...inside(name, children)])
    .slice(0, PATHS_MAX);
}

function Domain({ domain }: { readonly domain: PlanDomain }) {
  const { skills, predicates, functions, findings } = domain;
  return (
    <>
      <Findings findings={findings} />
      {skills.length === 0 && findings.length === 0 && (
        <p className="planner-soft">
          No library here has a planner annotation. Select a library’s root state and add one in the
          inspector.
        </p>
      )}
      {skills.length > 0 && (
        <details className="planner-more">
          <summary>
            {counted(skills.length, "skill")}, {counted(predicates.length, "predicate")}
            {functions.length > 0 && `, ${counted(functions.length, "number")}`}
          </summary>
          <ul className="planner-skills">
            {skills.map((skill) => (
              <li key={skill.library} title={skill.pddl}>
                <LibraryLink path={skill.library}>{skill.title}</LibraryLink>
                <code>{signatureOf(skill)}</code>
                {skill.description !== "" && (
                  <span className="planner-soft">{skill.description}</span>
                )}
              </li>
            ))}
          </ul>
        </details>
      )}
    </>
  );
}

function counted(many: number, word: string): string {
  return `${many} ${word}${many === 1 ? "" : "s"}`;
}

function signatureOf({ action, parameters }: PlanSkill): string {
  const typed = parameters.map(({ name, types }) =>
    types.length === 0 ? name : `${name}: ${types.join("|")}`,
  );
  return `${action}(${typed.join(", ")})`;
}
