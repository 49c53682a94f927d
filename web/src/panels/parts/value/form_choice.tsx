/** Buttons that choose the display format of a value. */

import { useSignal } from "../../../ui/signals.ts";
import { chooseForm, forms, type ValueForm } from "./kept_choice.ts";

const TITLES: Readonly<Record<ValueForm, string>> = {
  list: "List",
  table: "Table",
  image: "Image",
  plot: "Plot",
};

/** Chosen format for values of this kind, or the first one; null if there is none. */
export function useForm(kind: string, options: readonly ValueForm[]): ValueForm | null {
  const chosen = useSignal(forms)[kind];
  return options.find((option) => option === chosen) ?? options[0] ?? null;
}

interface FormChoiceProps {
  readonly kind: string;
  readonly options: readonly ValueForm[];
  readonly form: ValueForm | null;
  readonly name: string;
}

export function FormChoice({ kind, options, form, name }: FormChoiceProps) {
  if (options.length < 2) return null;
  return (
    <fieldset className="value-forms" aria-label={`Show ${name} as`}>
      {options.map((option) => (
        <button
          key={option}
          type="button"
          className="value-form"
          aria-pressed={option === form}
          onClick={() => chooseForm(kind, option)}
        >
          {TITLES[option]}
        </button>
      ))}
    </fieldset>
  );
}
