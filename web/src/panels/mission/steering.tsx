/** Buttons of a run in fixed positions: Stop and Pause, which need a second press, and Resume and Step. */

import { CirclePause, CirclePlay, CircleStop, Footprints, type LucideIcon } from "lucide-react";
import type { MouseEvent, ReactNode } from "react";
import type { Watch } from "../../store/history/run.ts";
import type { FreeCommandId } from "../../store/page/command_arguments.ts";
import { useConfirmPress } from "../../ui/confirm_press.ts";
import { isSameRecord, useComputed } from "../../ui/signals.ts";
import { useCommand, useHost, useRefusalOf } from "../context.tsx";

export function Steering() {
  const run = useCommand();
  const refusal = useRefusals();
  return (
    <section className="mission-steering" aria-label="Steering">
      <ConfirmButton
        className="mission-stop"
        name="Stop"
        sign={CircleStop}
        refusal={refusal["run.stop"]}
        onSure={() => run("run.stop", "sure")}
      />
      <ConfirmButton
        className="mission-pause"
        name="Pause"
        sign={CirclePause}
        refusal={refusal["run.pause"]}
        onSure={() => run("run.pause")}
      />
      <ActionButton
        name="Resume"
        sign={CirclePlay}
        refusal={refusal["run.resume"]}
        command="run.resume"
      />
      <ActionButton
        name="Step"
        sign={Footprints}
        refusal={refusal["run.over"]}
        command="run.over"
      />
    </section>
  );
}

const USED = ["run.stop", "run.pause", "run.resume", "run.over"] as const;
type Refusals = Readonly<Record<(typeof USED)[number], string | null>>;

/** Reasons why commands are unavailable. */
function useRefusals(): Refusals {
  const { commands, context } = useHost();
  return useComputed(
    () => {
      const now = context();
      return Object.fromEntries(USED.map((id) => [id, commands.refusalOf(id, now)])) as Refusals;
    },
    [commands, context],
    isSameRecord,
  );
}

/** Reason why an active run cannot be stopped. The holder of control is shown below. */
export function WhyNot({ watch }: { readonly watch: Watch }) {
  const why = useRefusalOf("run.stop");
  const isOn = useComputed(() => watch.now.value?.run.phase === "live", [watch]);
  // The part below has the details of a finished or crashed run.
  return why && isOn ? <p className="mission-why">{capital(why)}.</p> : null;
}

interface PressProps {
  readonly name: string;
  readonly sign: LucideIcon;
  readonly refusal: string | null;
}

/** Button that needs a second press, and announces its effect after the first. A key that is held down presses once. */
function ConfirmButton({
  name,
  sign: Icon,
  refusal,
  className,
  onSure,
}: PressProps & { readonly className: string; readonly onSure: () => void }) {
  const { asks, press } = useConfirmPress(onSure);
  return (
    <BigButton
      className={`${className} ${asks ? "mission-asks" : ""}`}
      refusal={refusal}
      name={asks ? `Press again: ${name.toLowerCase()}` : name}
      onClick={press}
    >
      <Icon size={26} aria-hidden />
      <span>{asks ? "Press again" : name}</span>
      <span className="visually-hidden" aria-live="assertive">
        {asks ? `Press again within three seconds to ${name.toLowerCase()} the run` : ""}
      </span>
    </BigButton>
  );
}

function ActionButton({
  name,
  sign: Icon,
  refusal,
  command,
}: PressProps & { readonly command: FreeCommandId }) {
  const run = useCommand();
  return (
    <BigButton className="mission-once" refusal={refusal} name={name} onClick={() => run(command)}>
      <Icon size={22} aria-hidden />
      <span>{name}</span>
    </BigButton>
  );
}

interface BigButtonProps {
  readonly className: string;
  readonly refusal: string | null;
  readonly name: string;
  readonly onClick: (event: MouseEvent) => void;
  readonly children: ReactNode;
}

function BigButton({ className, refusal, name, onClick, children }: BigButtonProps) {
  return (
    <button
      type="button"
      className={`mission-large ${className}`}
      aria-label={name}
      disabled={refusal !== null}
      title={refusal ? `${name}: ${refusal}` : undefined}
      onKeyDown={(event) => {
        if (event.repeat) event.preventDefault();
      }}
      onClick={onClick}
    >
      {children}
    </button>
  );
}

function capital(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}
