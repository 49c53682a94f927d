/** Start parameters of a run: values of the root's inputs, a pause at the start, the policy after a crash, the retention. The last entries
 * are stored for each machine. */

import { useState } from "react";
import { textOfDefault } from "../../model/default_text.ts";
import type { JsonValue, Keeping, OnCrash, PortDocument } from "../../model/generated/protocol.ts";
import { portsOf } from "../../model/machine.ts";
import { readInput } from "../../model/run_input.ts";
import { shortType } from "../../model/types.ts";
import type { Start } from "../../store/history/run.ts";
import { BROWSER_STORE, kept } from "../../store/local_store.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { fileOfTab } from "../../store/run/running.ts";
import { Button } from "../../ui/button.tsx";
import { Dialog } from "../../ui/dialog.tsx";
import { Checkbox, Select, TextField } from "../../ui/field.tsx";
import type { NamedDialogProps } from "./dialogs.tsx";

/** The entries: texts of inputs by name. */
interface StartInputs {
  readonly inputs: Readonly<Record<string, string>>;
  readonly hold: boolean;
  readonly onCrash: OnCrash | "machine";
  readonly keeping: Keeping;
}

const FIRST: StartInputs = { inputs: {}, hold: false, onCrash: "machine", keeping: "full" };

function keyOf(tab: OpenTab): string {
  const file = fileOfTab(tab);
  return `rafcon.start ${file ? `${file.project}/${file.path}` : tab.session.id}`;
}

export function StartRunDialog({ asks: tab, answer }: NamedDialogProps<"start-run">) {
  const key = keyOf(tab);
  const [given, setGiven] = useState<StartInputs>(() => ({
    ...FIRST,
    ...kept<StartInputs>(BROWSER_STORE, key),
  }));
  const { machine } = tab.session;
  const root = machine.state(machine.root);
  const ports = root ? portsOf(root, "input") : [];
  const put = (change: Partial<StartInputs>) => setGiven({ ...given, ...change });
  const isRefused = ports.some((port) => refusalOf(port, given) !== null);
  const done = () => {
    if (isRefused) return;
    BROWSER_STORE.put(key, given);
    answer(startOf(ports, given));
  };
  return (
    <Dialog
      title={`Start “${root?.name ?? "run"}”`}
      width={560}
      onClose={() => answer(null)}
      footer={
        <>
          <Button onClick={() => answer(null)}>Cancel</Button>
          <Button kind="primary" disabled={isRefused} onClick={done}>
            {given.hold ? "Start paused" : "Start"}
          </Button>
        </>
      }
    >
      <form
        className="form"
        onSubmit={(event) => {
          event.preventDefault();
          done();
        }}
      >
        <Inputs ports={ports} given={given} put={put} />
        <Checkbox
          label="Pause before the first state, to step from there"
          checked={given.hold}
          onChange={(hold) => put({ hold })}
        />
        <Select
          label="Interrupted scripts, if the run's program dies"
          value={given.onCrash}
          options={ON_CRASH}
          onChange={(onCrash) => put({ onCrash })}
        />
        <Select
          label="Record"
          value={given.keeping}
          options={KEEPING}
          onChange={(keeping) => put({ keeping })}
        />
        <button type="submit" hidden aria-hidden />
      </form>
    </Dialog>
  );
}

const ON_CRASH = [
  { value: "machine", title: "follow the machine's setting, or wait for a decision" },
  { value: "ask", title: "wait for a decision" },
  { value: "abort", title: "end as aborted, so that the machine recovers by itself" },
  { value: "restart", title: "run again" },
] as const;

const KEEPING = [
  { value: "full", title: "everything, with all values" },
  { value: "status", title: "events only, without values" },
] as const;

interface InputsProps {
  readonly ports: readonly PortDocument[];
  readonly given: StartInputs;
  readonly put: (change: Partial<StartInputs>) => void;
}

function Inputs({ ports, given, put }: InputsProps) {
  if (ports.length === 0) return <p className="form-note">The machine has no inputs.</p>;
  return (
    <fieldset className="form-group">
      <legend>Inputs as Python values. Leave a field empty to use the default.</legend>
      {ports.map((port) => (
        <TextField
          key={port.id}
          label={`${port.name}: ${shortType(port.data_type)}`}
          mono
          value={given.inputs[port.name] ?? ""}
          placeholder={textOfDefault(port.default)}
          refusal={refusalOf(port, given)}
          onInput={(text) => put({ inputs: { ...given.inputs, [port.name]: text } })}
        />
      ))}
    </fieldset>
  );
}

function refusalOf(port: PortDocument, given: StartInputs): string | null {
  const text = given.inputs[port.name] ?? "";
  if (text.trim() === "") return null;
  const read = readInput(text, port.data_type);
  return "refused" in read ? read.refused : null;
}

function startOf(ports: readonly PortDocument[], given: StartInputs): Partial<Start> {
  const inputs: Record<string, JsonValue> = {};
  for (const { name, data_type } of ports) {
    const text = given.inputs[name] ?? "";
    const read = text.trim() === "" ? null : readInput(text, data_type);
    if (read && "value" in read) inputs[name] = read.value;
  }
  const on_crash = given.onCrash === "machine" ? null : given.onCrash;
  return { inputs, hold: given.hold, keeping: given.keeping, on_crash };
}
