/** Selection of an end of a connection, among all possible ports in its container. */

import { useId, useState } from "react";
import { type ElementRef, keyOf } from "../../model/element.ts";
import {
  type ConnectionEnds,
  type ConnectionRef,
  endInWords,
  endsIn,
  isPort,
  nameOf,
} from "../../model/ends.ts";
import { type Machine, portsOf } from "../../model/machine.ts";
import { idOf } from "../../model/path.ts";
import { fits, shortType } from "../../model/types.ts";

interface EndSelectProps {
  readonly machine: Machine;
  readonly container: string;
  readonly kind: ConnectionRef["kind"];
  readonly end: keyof ConnectionEnds;
  /** Label of the field, such as "To". */
  readonly label: string;
  readonly hideLabel?: boolean | undefined;
  readonly value: ElementRef | null;
  /** Other end. The type of this end must match it. */
  readonly other?: ElementRef | null | undefined;
  /** State that the table belongs to. Labels of its own ends omit its name, and those of the container have an arrow. */
  readonly own?: string | undefined;
  /** Label of the empty choice, which stays available. */
  readonly nothing?: string | undefined;
  readonly disabled?: boolean | undefined;
  readonly onChange: (end: ElementRef | null) => void;
}

/** Lists all choices only when the user is about to choose: a container may have thousands. */
export function EndSelect(props: EndSelectProps) {
  const { machine, container, value, nothing, label, hideLabel, disabled, onChange } = props;
  const id = useId();
  const [isNear, setNear] = useState(false);
  const choices = isNear ? choicesOf(props) : value ? [choiceOf(props, value)] : [];
  const come = () => setNear(true);
  return (
    <div className={hideLabel ? "inspector-end" : "field"}>
      <label className={hideLabel ? "visually-hidden" : "field-label"} htmlFor={id}>
        {label}
      </label>
      <select
        id={id}
        className={hideLabel ? "inspector-end-select" : "field-input"}
        value={value ? keyOf(value) : ""}
        title={value ? endInWords(machine, container, value) : nothing}
        disabled={disabled}
        onPointerEnter={come}
        onFocus={come}
        onChange={(event) => {
          const key = event.currentTarget.value;
          onChange(choices.find((choice) => choice.key === key)?.element ?? null);
        }}
      >
        {(nothing !== undefined || value === null) && (
          <option value="">{nothing ?? "Choose…"}</option>
        )}
        {choices.map(({ key, title, isUnfit }) => (
          <option key={key} value={key} disabled={isUnfit}>
            {title}
          </option>
        ))}
      </select>
    </div>
  );
}

interface EndChoice {
  readonly key: string;
  readonly element: ElementRef;
  readonly title: string;
  readonly isUnfit: boolean;
}

function choiceOf(
  { machine, container, own, hideLabel }: EndSelectProps,
  element: ElementRef,
): EndChoice {
  const key = keyOf(element);
  const isNamed = element.kind !== "income" && (element.path === own || element.path === container);
  if (!hideLabel || !isNamed)
    return { key, element, title: endInWords(machine, container, element), isUnfit: false };
  const name = nameOf(machine, element);
  return { key, element, title: element.path === own ? name : `↑ ${name}`, isUnfit: false };
}

function choicesOf(props: EndSelectProps): readonly EndChoice[] {
  const { machine, container, kind, end, other } = props;
  const choices = endsIn(machine, container, kind, end).map((element) => choiceOf(props, element));
  const counts = new Map<string, number>();
  for (const { title } of choices) counts.set(title, (counts.get(title) ?? 0) + 1);
  const wanted = other && typeOf(machine, other);
  return choices.map((choice) => {
    const isTwin = (counts.get(choice.title) ?? 0) > 1;
    const title = isTwin ? `${choice.title} (${idOf(choice.element.path)})` : choice.title;
    const type = typeOf(machine, choice.element);
    if (type === null || !wanted) return { ...choice, title };
    const isUnfit = end === "to" ? !fits(wanted, type) : !fits(type, wanted);
    return { ...choice, title: `${title}: ${shortType(type)}`, isUnfit };
  });
}

function typeOf(machine: Machine, element: ElementRef): string | null {
  const state = machine.state(element.path);
  if (!state || !isPort(element)) return null;
  return portsOf(state, element.kind).find(({ id }) => id === element.id)?.data_type ?? null;
}
