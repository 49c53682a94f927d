/** Question of a state: its message, the form, the remaining time, and the effect of the timeout. */

import { CircleHelp, Timer } from "lucide-react";
import { type FormEvent, useId, useState } from "react";
import type { Form, Question } from "../../model/generated/protocol.ts";
import type { Watch } from "../../store/history/run.ts";
import { clock1s } from "../../store/page/clock1s.ts";
import { timeLeft } from "../../store/run/question_time.ts";
import { Button } from "../../ui/button.tsx";
import { Checkbox, TextField } from "../../ui/field.tsx";
import { useComputed } from "../../ui/signals.ts";
import { useCommand, useHost, useRefusalOf } from "../context.tsx";
import {
  answerOf,
  deadlineInWords,
  type Filled,
  firstFilled,
  rangeInWords,
  refusalOfFilled,
} from "./answer.ts";
import { duration } from "./duration.ts";
import "./question.css";

/** Remaining time below which a question is urgent, in ms. */
const SOON_MS = 15_000;

interface QuestionFormProps {
  readonly watch: Watch;
  readonly question: Question;
  /** State that asks, as text. */
  readonly asker: string;
  /** True if the form has not moved for a while, so that a press on it is intended. */
  readonly isUnmoved: boolean;
}

export function QuestionForm({ watch, question, asker, isUnmoved }: QuestionFormProps) {
  const run = useCommand();
  const [filled, setFilled] = useState<Filled>(() => firstFilled(question.form));
  const id = useId();
  const refusal = useRefusalOf("run.answer");
  const isSent = useComputed(() => isUnderWay(watch, question.id), [watch, question.id]);
  const fault = refusalOfFilled(question.form, filled);
  const { buttons } = question.form;
  const press = (button: number) =>
    run("run.answer", { question, value: answerOf(question.form, filled, button) });
  const submit = (event: FormEvent) => {
    event.preventDefault();
    if (buttons.length > 0 && fault === null) press(0);
  };
  return (
    <form className="question" data-question={question.id} aria-labelledby={id} onSubmit={submit}>
      <p className="question-asker">
        <CircleHelp size={16} aria-hidden />
        <span>
          {asker} asks{question.timeout_ms === null ? ", without a timeout" : ""}
          {question.lost_link_ms == null
            ? ""
            : `, until the ground is silent for ${question.lost_link_ms / 1000} s`}
        </span>
      </p>
      <TimeLeft watch={watch} question={question} />
      <p id={id} className="question-text">
        {question.message}
      </p>
      <Entry form={question.form} filled={filled} fault={fault} onFill={setFilled} />
      <div className="question-buttons">
        {buttons.map((label, button) => (
          <Button
            // biome-ignore lint/suspicious/noArrayIndexKey: a button is identified by its index
            key={button}
            kind={button === 0 ? "primary" : "plain"}
            disabled={!isUnmoved || refusal !== null || isSent || (button === 0 && fault !== null)}
            title={refusal ? `Answer: ${refusal}` : undefined}
            onClick={() => press(button)}
          >
            {label}
          </Button>
        ))}
        <span className="question-status" aria-live="polite">
          {isSent ? "sent…" : ""}
        </span>
      </div>
      {refusal && <p className="question-why">You cannot answer: {refusal}.</p>}
    </form>
  );
}

/** True if a response of this page is pending. */
function isUnderWay(watch: Watch, question: number): boolean {
  return watch.sent.value.some(
    ({ command, answer }) =>
      answer === null && command.type === "answer_question" && command.question === question,
  );
}

interface AnswerEntryProps {
  readonly form: Form;
  readonly filled: Filled;
  readonly fault: string | null;
  readonly onFill: (filled: Filled) => void;
}

function Entry({ form, filled, fault, onFill }: AnswerEntryProps) {
  if (form.type === "buttons") return null;
  if (form.type === "checks") {
    return (
      <div className="question-boxes">
        {form.boxes.map((label, box) => (
          <Checkbox
            // biome-ignore lint/suspicious/noArrayIndexKey: a box is identified by its index
            key={box}
            label={label}
            checked={filled.checked[box] ?? false}
            onChange={(on) => onFill({ ...filled, checked: filled.checked.with(box, on) })}
          />
        ))}
      </div>
    );
  }
  const isNumber = form.type === "number";
  const isTouched = filled.text !== firstFilled(form).text;
  return (
    <TextField
      label={isNumber ? `Your answer: a ${rangeInWords(form)}` : "Your answer"}
      value={filled.text}
      onInput={(text) => onFill({ ...filled, text })}
      refusal={isTouched ? fault : null}
    />
  );
}

/** True if little time remains for a response. */
export function isSoon(left_ms: number | null): boolean {
  return left_ms !== null && left_ms <= SOON_MS;
}

/** Remaining time for a response, and the effect of the timeout. */
function TimeLeft({ watch, question }: Pick<QuestionFormProps, "watch" | "question">) {
  const { page } = useHost().context();
  const { timeout_ms } = question;
  const left = useComputed(
    () => timeLeft(page, watch, question, clock1s.value),
    [page, watch, question],
  );
  if (timeout_ms === null || left === null) return null;
  const share = Math.min(1, left / timeout_ms);
  return (
    <p className={`question-time ${isSoon(left) ? "question-soon" : ""}`} role="timer">
      <Timer size={16} aria-hidden />
      <strong>{left === 0 ? "time is up" : `${duration(left)} left`}</strong>
      <span>{deadlineInWords(question)}</span>
      <span className="question-bar" aria-hidden>
        <span style={{ width: `${share * 100}%` }} />
      </span>
    </p>
  );
}
