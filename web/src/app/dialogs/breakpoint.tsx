/** A breakpoint in all its parts. */

import { useState } from "react";
import { cannotSetConditions } from "../../commands/run_points.ts";
import type { Breakpoint } from "../../model/generated/protocol.ts";
import { secondsOf } from "../../model/lost_link.ts";
import { namesTo } from "../../model/machine.ts";
import { Button } from "../../ui/button.tsx";
import { Dialog } from "../../ui/dialog.tsx";
import { Checkbox, Select, TextField } from "../../ui/field.tsx";
import { useSession } from "../session_context.tsx";
import type { NamedDialogProps } from "./dialogs.tsx";

export function BreakpointDialog({ asks, answer }: NamedDialogProps<"breakpoint">) {
  const { context } = useSession();
  const now = context();
  const [wanted, setWanted] = useState(asks);
  const [count, setCount] = useState(String(Math.max(1, asks.hit_count)));
  const [silence, setSilence] = useState(
    asks.lost_link_ms == null ? "" : String(asks.lost_link_ms / 1000),
  );
  const put = (change: Partial<Breakpoint>) => setWanted({ ...wanted, ...change });
  const machine = now.tab?.session.machine;
  const isCount = /^[1-9]\d*$/.test(count.trim());
  const silence_s = silence.trim() === "" ? null : secondsOf(silence);
  const isFit = isCount && (silence_s !== null || silence.trim() === "");
  const done = () => {
    const lost_link_ms = silence_s === null ? null : Math.round(silence_s * 1000);
    if (isFit) answer({ ...wanted, hit_count: Number(count), lost_link_ms });
  };
  return (
    <Dialog
      title={`Breakpoint ${asks.id}`}
      width={520}
      onClose={() => answer(null)}
      footer={
        <>
          <Button onClick={() => answer(null)}>Cancel</Button>
          <Button kind="primary" disabled={!isFit} onClick={done}>
            Set
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
        <p className="form-note">{machine ? namesTo(machine, asks.path).join(" › ") : asks.path}</p>
        <Parts wanted={wanted} put={put} count={count} isCount={isCount} onCount={setCount} />
        <TextField
          label="Also once the ground is silent for (s)"
          value={silence}
          placeholder="never"
          disabled={wanted.unattended === "hold"}
          hint={
            wanted.unattended === "hold"
              ? "A breakpoint that pauses anyway waits for the ground."
              : "For a robot with a station: applies when its ground sends no signal for this long."
          }
          refusal={
            isFit || !isCount ? null : "a number of seconds between 0 and a year, or nothing"
          }
          onInput={setSilence}
        />
        <button type="submit" hidden aria-hidden />
      </form>
    </Dialog>
  );
}

interface BreakpointPartsProps {
  readonly wanted: Breakpoint;
  readonly put: (change: Partial<Breakpoint>) => void;
  /** As it was typed. */
  readonly count: string;
  readonly isCount: boolean;
  readonly onCount: (text: string) => void;
}

function Parts({ wanted, put, count, isCount, onCount }: BreakpointPartsProps) {
  const { context } = useSession();
  const unfit = cannotSetConditions(context());
  return (
    <>
      <Select
        label="Pauses"
        value={wanted.when}
        options={WHEN}
        onChange={(when) => put({ when })}
      />
      <TextField
        label="Condition (Python)"
        mono
        value={wanted.condition ?? ""}
        placeholder={wanted.when === "after" ? 'outputs["count"] == 3' : 'inputs["count"] == 3'}
        disabled={unfit !== null}
        hint={
          unfit ??
          "Available: inputs, scoped, gvm; after the state also outputs and outcome. Empty: always."
        }
        onInput={(text) => put({ condition: text.trim() === "" ? null : text })}
      />
      <TextField
        label="Starting with hit"
        type="number"
        value={count}
        refusal={isCount ? null : "a whole number, 1 or greater"}
        hint="1: every hit; 3: from the third hit that meets the condition"
        onInput={onCount}
      />
      <Select
        label="Scope of the pause"
        value={wanted.scope}
        options={SCOPE}
        onChange={(scope) => put({ scope })}
      />
      <Select
        label="While nobody is connected"
        value={wanted.unattended}
        options={UNATTENDED}
        onChange={(unattended) => put({ unattended })}
      />
      <Checkbox label="Enabled" checked={wanted.enabled} onChange={(enabled) => put({ enabled })} />
    </>
  );
}

const WHEN = [
  { value: "before", title: "before the state" },
  { value: "after", title: "after the state" },
] as const;

const SCOPE = [
  { value: "branch", title: "its branch" },
  { value: "run", title: "the whole run" },
] as const;

const UNATTENDED = [
  { value: "hold", title: "pause anyway" },
  { value: "continue", title: "continue the run" },
  { value: "stop", title: "stop the run" },
] as const;
