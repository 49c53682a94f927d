/** Control of the run: its holder, requests for it, and the available actions. */

import { ArrowRightLeft, Hand, KeyRound, LogOut, ShieldAlert, Undo2 } from "lucide-react";
import type { ReactNode } from "react";
import { silenceLeft } from "../../commands/control.ts";
import { lacks } from "../../commands/run_rules.ts";
import { isLive } from "../../model/run_words.ts";
import type { Watch } from "../../store/history/run.ts";
import type { FreeCommandId } from "../../store/page/command_arguments.ts";
import { wallTime } from "../../store/page/times.ts";
import { sessionOfPage } from "../../store/run/running.ts";
import { Button } from "../../ui/button.tsx";
import { useComputed } from "../../ui/signals.ts";
import { useCommand, useHost, useRefusalOf } from "../context.tsx";
import { duration } from "../parts/duration.ts";
import { Identity } from "./identity.tsx";

export function ControlPart({ watch }: { readonly watch: Watch }) {
  const { page } = useHost().context();
  const control = useComputed(() => watch.now.value?.control ?? null, [watch]);
  const user = useComputed(() => sessionOfPage(page)?.user ?? null, [page]);
  const isOn = useComputed(() => {
    const run = watch.now.value?.run;
    return isLive(run?.phase);
  }, [watch]);
  if (!control || !isOn) {
    return (
      <section className="mission-part" aria-label="Users">
        <Identity />
      </section>
    );
  }
  const { holder, requests } = control;
  const isMine = holder !== null && holder === user;
  return (
    <section className="mission-part mission-control" aria-label="Control of the run">
      <p className="mission-holder shows-run">
        <KeyRound size={18} aria-hidden />
        <span>
          {holder === null ? (
            <>
              <strong>Nobody</strong> is in control: the first user to give a command gets control.
            </>
          ) : (
            <>
              <strong>{isMine ? "You are" : `${holder} is`}</strong> in control
              <span className="mission-soft"> since {wallTime(control.since_ms, Date.now())}</span>
            </>
          )}
        </span>
      </p>
      {requests.length > 0 && (
        <ul className="mission-askers" aria-label="Requests for control">
          {requests.map((asker) => (
            <li key={asker}>
              <Hand size={16} aria-hidden />
              <span>
                <strong>{asker === user ? "You ask" : `${asker} asks`}</strong> for control
              </span>
              {isMine && (
                <Move
                  command="control.hand-over"
                  argument={asker}
                  title={`Hand over to ${asker}`}
                  primary
                />
              )}
            </li>
          ))}
        </ul>
      )}
      {control.offered_to && (
        <Offer holder={holder} to={control.offered_to} isMine={isMine} user={user} />
      )}
      <Moves isMine={isMine} holder={holder} asks={requests.includes(user ?? "")} />
      <Identity />
    </section>
  );
}

interface OfferProps {
  readonly holder: string | null;
  readonly to: string;
  readonly isMine: boolean;
  readonly user: string | null;
}

/** Offer of control that is not accepted yet. The holder keeps control until then. */
function Offer({ holder, to, isMine, user }: OfferProps) {
  const isForMe = to === user;
  if (!isMine && !isForMe) {
    return (
      <p className="mission-soft">
        {holder} offers control to {to}, who has not accepted it yet
      </p>
    );
  }
  return (
    <div className="mission-offer" role="group" aria-label="Control is offered">
      <p role="status">
        <ArrowRightLeft size={16} aria-hidden />
        {isForMe ? (
          <span>
            <strong>{holder}</strong> offers you control
          </span>
        ) : (
          <span>
            Offered to <strong>{to}</strong>, not accepted yet
          </span>
        )}
      </p>
      <div className="mission-buttons">
        {isForMe ? (
          <>
            <Move command="control.accept" title="Accept" primary />
            <Move command="control.decline" title="Decline" />
          </>
        ) : (
          <Move command="control.withdraw" title="Withdraw" />
        )}
      </div>
    </div>
  );
}

function Moves({
  isMine,
  holder,
  asks,
}: {
  readonly isMine: boolean;
  readonly holder: string | null;
  readonly asks: boolean;
}) {
  const { page } = useHost().context();
  const missing = useComputed(() => lacks(page, "command"), [page]);
  if (missing !== null) {
    return <p className="mission-why">You cannot take control: {missing}.</p>;
  }
  if (isMine) {
    return (
      <div className="mission-buttons">
        <Move command="control.release" title="Release" sign={<LogOut size={16} aria-hidden />} />
        <Move
          command="control.hand-over"
          title="Hand over to…"
          sign={<ArrowRightLeft size={16} aria-hidden />}
        />
      </div>
    );
  }
  return (
    <div className="mission-buttons">
      {asks ? (
        <Move
          command="control.withdraw"
          title="Withdraw request"
          sign={<Undo2 size={16} aria-hidden />}
        />
      ) : (
        <Move
          command="control.request"
          title={holder === null ? "Take control" : "Ask for control"}
          sign={<Hand size={16} aria-hidden />}
        />
      )}
      {holder !== null && <TakeOver holder={holder} />}
      {holder !== null && <Override />}
    </div>
  );
}

/** Takes control from a silent holder. Shows the time until that is possible. */
function TakeOver({ holder }: { readonly holder: string }) {
  const { context } = useHost();
  const left = useComputed(() => Math.ceil(silenceLeft(context()) / 1_000), [context]);
  return (
    <>
      <Move
        command="control.take-over"
        title="Take over"
        sign={<KeyRound size={16} aria-hidden />}
        disabled={left > 0}
      />
      <span className="mission-soft">
        {left > 0
          ? `possible after ${holder} has been silent for ${duration(left * 1_000)} more`
          : `${holder} has been silent for a while`}
      </span>
    </>
  );
}

/** Button for admins. Other users do not see it. */
function Override() {
  const { page } = useHost().context();
  const mayNot = useComputed(() => lacks(page, "administer") !== null, [page]);
  if (mayNot) return null;
  return (
    <Move
      command="control.override"
      title="Take control…"
      sign={<ShieldAlert size={16} aria-hidden />}
    />
  );
}

type ControlId = Extract<FreeCommandId, `control.${string}`>;

interface MoveProps {
  readonly command: ControlId;
  readonly title: string;
  readonly argument?: string;
  readonly sign?: ReactNode;
  readonly primary?: boolean;
  /** True to disable the button. The default depends on the command's own refusal. */
  readonly disabled?: boolean;
}

function Move({ command, title, argument, sign, primary, disabled }: MoveProps) {
  const run = useCommand();
  const refusal = useRefusalOf(command);
  return (
    <Button
      kind={primary ? "primary" : "plain"}
      icon={sign}
      disabled={disabled ?? refusal !== null}
      title={refusal ? `${title}: ${refusal}` : undefined}
      onClick={() => (command === "control.hand-over" ? run(command, argument) : run(command))}
    >
      {title}
    </Button>
  );
}
