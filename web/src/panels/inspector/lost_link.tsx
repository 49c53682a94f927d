/** Policies of a state for a lost link to the ground, or for a lack of commands: its own, or inherited ones. */

import type { Loss } from "../../model/generated/protocol.ts";
import {
  LOSSES,
  type LossMeasure,
  type LossPolicy,
  MEASURES,
  ownPolicy,
  policyAround,
  policyInWords,
  secondsOf,
  withPolicy,
} from "../../model/lost_link.ts";
import { setSemanticData } from "../../plan/states.ts";
import type { Made } from "../../store/page/apply_plan.ts";
import { Select, TextField } from "../../ui/field.tsx";
import { Fold } from "./fold.tsx";
import type { InspectedState } from "./inspector_context.ts";
import { Refusal, useRefusal } from "./refusal.tsx";

const TITLES: Readonly<Record<Loss, string>> = {
  link: "While there is no signal from the ground",
  command: "While nobody gives a command",
};

const FIELDS: Readonly<Record<LossMeasure, { readonly label: string; readonly hint: string }>> = {
  finish_s: { label: "Finish after", hint: "The state ends, then its branch is paused." },
  hold_s: { label: "Pause after", hint: "No state inside begins." },
  recover_s: {
    label: "Recover after",
    hint: "The state is preempted; its outcome preempted leads on.",
  },
};

/** Initial policy when the user adds one: pause after half a minute. */
const FIRST: LossPolicy = { hold_s: 30 };

export function LostLink({ inspected }: { inspected: InspectedState }) {
  const data = inspected.state.semantic_data;
  const count = LOSSES.filter((loss) => ownPolicy(data, loss) !== null).length;
  return (
    <Fold title="Lost link" count={count} openAtFirst={count > 0}>
      {LOSSES.map((loss) => (
        <Policy key={loss} inspected={inspected} loss={loss} />
      ))}
    </Fold>
  );
}

type Choice = "inherit" | "continue" | "act" | "unclear";

function Policy({ inspected, loss }: { inspected: InspectedState; loss: Loss }) {
  const { path, state, machine, readOnly, edit } = inspected;
  const [refusal, run] = useRefusal();
  const own = ownPolicy(state.semantic_data, loss);
  const around = policyAround(machine, path, loss);
  const put = (policy: LossPolicy | null): Made =>
    edit((now) =>
      setSemanticData(now, path, withPolicy(now.state(path)?.semantic_data, loss, policy)),
    );
  const inherited = around
    ? `As ${machine.state(around.path)?.name ?? around.path}: ${policyInWords(around.policy)}`
    : "Continue (nothing is set)";
  const options: { value: Choice; title: string; disabled?: boolean }[] = [
    { value: "inherit", title: inherited },
    { value: "continue", title: "Continue" },
    { value: "act", title: "Act after a time" },
  ];
  if (own === "unclear") {
    options.push({ value: "unclear", title: "Not understood: see semantic data", disabled: true });
  }
  const choose = (choice: Choice) => {
    if (choice === "act") run(put(FIRST));
    else if (choice !== "unclear") run(put(choice === "continue" ? {} : null));
  };
  return (
    <section className="inspector-group" aria-label={TITLES[loss]}>
      <div className="inspector-group-head">
        <h4>{TITLES[loss]}</h4>
      </div>
      <div className="inspector-fields">
        <Select
          label="Policy"
          value={choiceOf(own)}
          disabled={readOnly}
          options={options}
          onChange={choose}
        />
        {own !== null &&
          own !== "unclear" &&
          choiceOf(own) === "act" &&
          MEASURES.map((measure) => (
            <Seconds key={measure} measure={measure} policy={own} readOnly={readOnly} put={put} />
          ))}
      </div>
      <Refusal text={refusal} />
    </section>
  );
}

function choiceOf(own: LossPolicy | "unclear" | null): Choice {
  if (own === null) return "inherit";
  if (own === "unclear") return "unclear";
  return Object.keys(own).length === 0 ? "continue" : "act";
}

interface SecondsProps {
  readonly measure: LossMeasure;
  readonly policy: LossPolicy;
  readonly readOnly: boolean;
  readonly put: (policy: LossPolicy) => Made;
}

function Seconds({ measure, policy, readOnly, put }: SecondsProps) {
  const { label, hint } = FIELDS[measure];
  const commit = (text: string): Made => {
    const { [measure]: _, ...others } = policy;
    const seconds = secondsOf(text);
    return put(seconds === null ? others : { ...others, [measure]: seconds });
  };
  const isFault = (text: string) => text.trim() !== "" && secondsOf(text) === null;
  return (
    <TextField
      label={`${label} (s)`}
      value={policy[measure] === undefined ? "" : String(policy[measure])}
      placeholder="never"
      readOnly={readOnly}
      hint={hint}
      check={(text) => (isFault(text) ? "Enter seconds between 0 and a year, or nothing." : null)}
      onCommit={commit}
    />
  );
}
