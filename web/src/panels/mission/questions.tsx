/** Questions of states with their forms, and the last closed questions with their results. */

import { askedQuestions, type Closed, openQuestions } from "../../store/history/questions.ts";
import type { Watch } from "../../store/history/run.ts";
import { byUrgency } from "../../store/run/question_time.ts";
import { useComputed, useSignal } from "../../ui/signals.ts";
import { useStableFor } from "../../ui/stable_for.ts";
import { answerInWords } from "../parts/answer.ts";
import { QuestionForm } from "../parts/question.tsx";
import { pathInWords, useMachineNames } from "./names.ts";
import { useWhen } from "./when.ts";

/** Maximum number of closed questions. */
const CLOSED_SHOWN = 3;

export function Questions({ watch }: { readonly watch: Watch }) {
  const open = useComputed(() => byUrgency(watch, openQuestions(watch)), [watch]);
  const { closed } = useSignal(askedQuestions(watch));
  const names = useMachineNames();
  const isOpen = new Set(open.map(({ id }) => id));
  const isUnmoved = useStableFor(open.map(({ id }) => id).join(" "));
  const ended = closed.filter(({ question }) => !isOpen.has(question.id)).slice(0, CLOSED_SHOWN);
  if (open.length === 0 && ended.length === 0) return null;
  return (
    <section className="mission-part" aria-label="Questions">
      {open.map((question) => (
        <QuestionForm
          key={question.id}
          watch={watch}
          question={question}
          isUnmoved={isUnmoved}
          asker={pathInWords(names, question.path)}
        />
      ))}
      {ended.length > 0 && (
        <ul className="mission-closed" aria-label="Closed questions">
          {ended.map((end) => (
            <Ended key={end.question.id} watch={watch} end={end} />
          ))}
        </ul>
      )}
    </section>
  );
}

function Ended({ watch, end }: { readonly watch: Watch; readonly end: Closed }) {
  const when = useWhen(watch, end.t_ns / 1e6);
  return (
    <li>
      <span>{end.question.message}</span>
      <strong>{endInWords(end)}</strong>
      <time>{when}</time>
    </li>
  );
}

function endInWords({ question, how, answer, author }: Closed): string {
  const words = answerInWords(question.form, answer);
  switch (how) {
    case "answered":
      return `${author || "Someone"} answered “${words}”`;
    case "timed_out":
      return words === "" ? "nobody answered in time" : `nobody answered in time: “${words}”`;
    case "withdrawn":
      return "withdrawn by the state";
  }
}
