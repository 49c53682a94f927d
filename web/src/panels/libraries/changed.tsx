/** Library states of the active machine with changed libraries, and the commands that update them. */

import { Wrench } from "lucide-react";
import type { MachineProblem } from "../../model/generated/protocol.ts";
import { elementOfProblem } from "../../model/problem.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { mayEdit } from "../../store/page/rights.ts";
import { Button } from "../../ui/button.tsx";
import { Section } from "../../ui/section.tsx";
import { useSignal } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { reveal } from "../reveal.ts";

export function Changed({ tab }: { readonly tab: OpenTab }) {
  const problems = useSignal(tab.session.problems).filter(isAboutLibrary);
  if (problems.length === 0) return null;
  return (
    <Section title="Changed libraries" count={problems.length}>
      <ul className="libraries-changed">
        {problems.map((problem) => (
          <li key={`${problem.path}\n${problem.part}\n${problem.rule}`}>
            <OneChanged tab={tab} problem={problem} />
          </li>
        ))}
      </ul>
    </Section>
  );
}

function isAboutLibrary({ rule }: MachineProblem): boolean {
  return /^library|^runtime_?value/i.test(rule);
}

/** Message with the name of the state in place of its path at the beginning. */
function inWords({ session }: OpenTab, { path, message }: MachineProblem): string {
  const name = session.machine.state(path)?.name;
  const [, rest] = /^[^:]*: (.*)$/s.exec(message) ?? [];
  return name && rest && message.startsWith(path) ? `“${name}”: ${rest}` : message;
}

function OneChanged({ tab, problem }: { readonly tab: OpenTab; readonly problem: MachineProblem }) {
  const host = useHost();
  const may = mayEdit(host.context().page);
  return (
    <>
      <button
        type="button"
        className="libraries-link"
        onClick={() => reveal(host, elementOfProblem(problem))}
      >
        {tab.session.named(inWords(tab, problem))}
      </button>
      {(problem.repairs ?? []).map(({ name, edit }) => (
        <Button
          key={name}
          icon={<Wrench size={14} />}
          disabled={!may}
          onClick={() => void tab.session.edit(name, edit)}
        >
          {name}
        </Button>
      ))}
    </>
  );
}
