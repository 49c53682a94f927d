/** Fields: text that counts once it is committed, choices, boxes to tick. */

import {
  createContext,
  type KeyboardEvent,
  type ReactNode,
  useContext,
  useEffect,
  useId,
  useRef,
  useState,
} from "react";
import { givenUpInWords, isOthers, meanwhileInWords } from "./meanwhile.ts";
import "./field.css";

/** Result of a commit: nothing on success, or the reason of a refusal. */
type Committed = string | null | undefined;

/** A question is open: the focus stays where it is. */
export interface CommitQuestion {
  readonly asked: Promise<Committed>;
}

/** Result for an editor: immediate, later, or after a question. */
export type Commit = Committed | void | Promise<Committed> | Promise<void> | CommitQuestion;

/** Final result. */
export async function committed(commit: Commit): Promise<Committed> {
  const result = await (isAsked(commit) ? commit.asked : commit);
  return result ?? null;
}

/** True if a question is open. */
function isAsked(commit: Commit): commit is CommitQuestion {
  return typeof commit === "object" && commit !== null && "asked" in commit;
}

/** Reports the refusal of a text whose field no longer exists. */
export const LostTexts = createContext<(text: string) => void>(() => {});

interface TextFieldProps {
  readonly label: string;
  /** Hidden label for screen readers. */
  readonly hideLabel?: boolean | undefined;
  readonly value: string;
  /** Called on Enter (of several lines Ctrl+Enter) and blur, if the text is another one. */
  readonly onCommit?: ((text: string) => Commit) | undefined;
  /** Called at each key: for searches. */
  readonly onInput?: ((text: string) => void) | undefined;
  /** Reason why the present text would be refused; null if it is valid. */
  readonly check?: ((text: string) => string | null) | undefined;
  readonly refusal?: string | null | undefined;
  readonly hint?: string | undefined;
  readonly placeholder?: string | undefined;
  readonly multiline?: boolean | undefined;
  readonly mono?: boolean | undefined;
  readonly disabled?: boolean | undefined;
  readonly readOnly?: boolean | undefined;
  readonly autoFocus?: boolean | undefined;
  readonly type?: "text" | "search" | "password" | "number" | undefined;
  readonly autoComplete?: string | undefined;
  /** Texts that are offered. */
  readonly suggestions?: readonly string[] | undefined;
  /** Keys that the field itself does not use. */
  readonly onKeyDown?: ((event: KeyboardEvent<HTMLElement>) => void) | undefined;
}

export function TextField(props: TextFieldProps) {
  const { label, hideLabel, hint, multiline, mono, suggestions } = props;
  const id = useId();
  const draft = useDraft(props);
  const Input = multiline ? "textarea" : "input";
  const message = draft.refusal ?? hint;
  return (
    <div className="field">
      <label className={hideLabel ? "visually-hidden" : "field-label"} htmlFor={id}>
        {label}
      </label>
      <Input
        id={id}
        className={`field-input ${mono ? "field-mono" : ""}`}
        value={draft.text}
        type={multiline ? undefined : (props.type ?? "text")}
        placeholder={props.placeholder}
        disabled={props.disabled}
        readOnly={props.readOnly}
        autoFocus={props.autoFocus}
        autoComplete={props.autoComplete ?? "off"}
        spellCheck={multiline && !mono}
        list={suggestions && !multiline ? `${id}-list` : undefined}
        aria-invalid={draft.refusal ? true : undefined}
        aria-describedby={message ? `${id}-message` : undefined}
        onChange={(event) => draft.typed(event.currentTarget.value)}
        onBlur={draft.commit}
        onKeyDown={draft.key}
      />
      {suggestions && (
        <datalist id={`${id}-list`}>
          {suggestions.map((text) => (
            <option key={text} value={text} />
          ))}
        </datalist>
      )}
      {message && (
        <span
          id={`${id}-message`}
          className={draft.refusal ? "field-refusal" : "field-hint"}
          role={draft.refusal ? "alert" : undefined}
        >
          {message}
        </span>
      )}
    </div>
  );
}

/** The text as it is typed, which is committed too when the field goes away. What comes from outside replaces it unless somebody
 * is typing: then only Enter overwrites what came. */
function useDraft({
  value,
  onCommit,
  onInput,
  check,
  refusal,
  multiline,
  label,
  ...more
}: TextFieldProps) {
  const lost = useContext(LostTexts);
  const [text, setText] = useState<string | null>(null);
  const [refused, setRefused] = useState<string | null>(null);
  const latest = useRef<string | null>(null);
  const isGone = useRef(false);
  const own = useRef<Set<string>>(new Set());
  const put = (next: string | null) => {
    latest.current = next;
    setText(next);
  };
  const typed = (next: string) => {
    if (latest.current === null) own.current = new Set([value]);
    put(next);
    setRefused(null);
    onInput?.(next);
  };
  const isBehind = onCommit !== undefined && isOthers(value, own.current, text);
  const commit = async (overwrites: boolean) => {
    const typedText = latest.current;
    if (typedText === null || !onCommit) return;
    if (typedText === value) return put(null);
    const loses = (why: string) => lost(`${label} “${typedText}” was not applied: ${why}`);
    if (isBehind && !overwrites) return isGone.current ? loses(givenUpInWords(value)) : undefined;
    const fault = check?.(typedText) ?? null;
    own.current.add(typedText);
    const answer = fault ?? (await committed(onCommit(typedText))) ?? null;
    if (answer !== null && isGone.current) return loses(answer);
    setRefused(answer);
    if (answer === null && latest.current === typedText) put(null);
  };
  const last = useRef(commit);
  last.current = commit;
  useEffect(() => {
    isGone.current = false;
    return () => {
      isGone.current = true;
      void last.current(false);
    };
  }, []);
  const key = (event: KeyboardEvent<HTMLElement>) => {
    if (event.key === "Enter" && (!multiline || event.ctrlKey || event.metaKey)) {
      if (onCommit) event.preventDefault();
      void commit(true);
    } else if (event.key === "Escape" && latest.current !== null && onCommit) {
      event.stopPropagation();
      event.preventDefault();
      put(null);
      setRefused(null);
      return;
    }
    more.onKeyDown?.(event);
  };
  const checked = text === null ? null : (check?.(text) ?? null);
  const warning = isBehind ? meanwhileInWords(value, multiline ? "Ctrl+Enter" : "Enter") : null;
  return {
    text: text ?? value,
    refusal: refused ?? checked ?? warning ?? refusal ?? null,
    typed,
    commit: () => void commit(false),
    key,
  };
}

interface SelectProps<T extends string> {
  readonly label: string;
  readonly hideLabel?: boolean | undefined;
  readonly value: T;
  readonly options: readonly {
    readonly value: T;
    readonly title: string;
    readonly disabled?: boolean;
  }[];
  readonly onChange: (value: T) => void;
  readonly disabled?: boolean | undefined;
}

export function Select<T extends string>(props: SelectProps<T>) {
  const id = useId();
  return (
    <div className="field">
      <label className={props.hideLabel ? "visually-hidden" : "field-label"} htmlFor={id}>
        {props.label}
      </label>
      <select
        id={id}
        className="field-input"
        value={props.value}
        disabled={props.disabled}
        onChange={(event) => props.onChange(event.currentTarget.value as T)}
      >
        {props.options.map(({ value, title, disabled }) => (
          <option key={value} value={value} disabled={disabled}>
            {title}
          </option>
        ))}
      </select>
    </div>
  );
}

interface CheckboxProps {
  readonly label: ReactNode;
  readonly checked: boolean;
  readonly onChange: (checked: boolean) => void;
  readonly disabled?: boolean | undefined;
  readonly title?: string | undefined;
}

export function Checkbox({ label, checked, onChange, disabled, title }: CheckboxProps) {
  return (
    <label className="checkbox" title={title}>
      <input
        type="checkbox"
        checked={checked}
        disabled={disabled}
        onChange={(event) => onChange(event.currentTarget.checked)}
      />
      <span>{label}</span>
    </label>
  );
}
