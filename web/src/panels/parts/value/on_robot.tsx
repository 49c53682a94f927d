/** Value with bytes that are only on its robot: cost and progress of a transfer, and the buttons for it. */

import { Download, X } from "lucide-react";
import { useEffect, useState } from "react";
import { lacks, robotRefuses } from "../../../commands/run_rules.ts";
import type { KeptValue } from "../../../model/generated/protocol.ts";
import type { Watch } from "../../../store/history/run.ts";
import type { Page } from "../../../store/page/page.ts";
import { Button } from "../../../ui/button.tsx";
import { useComputed } from "../../../ui/signals.ts";
import { dataSize } from "../data_size.ts";
import { duration } from "../duration.ts";
import { useDetail } from "./use_detail.ts";
import "./on_robot.css";

/** Refresh intervals of the progress during a transfer, and of the cost without one, in ms. */
const COMING_MS = 1_000;
const COST_MS = 5_000;

type OnRobot = Extract<KeptValue, { kept: "on_robot" }>;

interface OnRobotProps {
  readonly page: Page;
  readonly watch: Watch;
  /** Event of the value; null if unknown. */
  readonly sequence: number | null;
  readonly name: string;
}

/** Empty if the whole value is on this server. */
export function OnRobotValue({ page, watch, sequence, name }: OnRobotProps) {
  const { detail } = useDetail(page.runs, watch.id, sequence);
  const values = detail?.sequence === sequence ? detail.values : [];
  const found = values.find((each) => each.name === name);
  if (found?.value.kept !== "on_robot") return null;
  return (
    <Fetching key={found.value.number} page={page} watch={watch} name={name} first={found.value} />
  );
}

interface FetchingProps {
  readonly page: Page;
  readonly watch: Watch;
  readonly name: string;
  readonly first: OnRobot;
}

function Fetching({ page, watch, name, first }: FetchingProps) {
  const run = watch.id;
  const [kept, setKept] = useState<KeptValue>(first);
  const [refusal, setRefusal] = useState<string | null>(null);
  const missing = useComputed(
    () => lacks(page, "command") ?? robotRefuses(watch, "command"),
    [page, watch],
  );
  const path = `values/${first.number}`;
  const isOnRobot = kept.kept === "on_robot";
  const isComing = kept.kept === "on_robot" && kept.fetch !== null && kept.fetch.failed === null;
  const ask = (question: Promise<KeptValue>) =>
    question.then(
      (value) => {
        setKept(value);
        setRefusal(null);
      },
      (error: unknown) => setRefusal(error instanceof Error ? error.message : String(error)),
    );
  // biome-ignore lint/correctness/useExhaustiveDependencies: `ask` depends only on the value
  useEffect(() => {
    if (!isOnRobot) return;
    const again = () => void ask(page.runs.get<KeptValue>(run, path));
    again();
    const timer = setInterval(again, isComing ? COMING_MS : COST_MS);
    return () => clearInterval(timer);
  }, [isOnRobot, isComing, run, path]);
  if (kept.kept !== "on_robot") {
    return kept.kept === "pickle" ? (
      <p className="on-robot on-robot-here">
        All {dataSize(kept.bytes)} of {name} are here, and right by their hash.
      </p>
    ) : null;
  }
  const send = (method: "POST" | "DELETE") =>
    void ask(page.runs.fetchValue<KeptValue>(run, first.number, method === "POST"));
  return (
    <div className="on-robot" role="group" aria-label={`${name} on the robot`}>
      <p className="on-robot-words">{words(kept)}</p>
      {kept.fetch && (isComing || kept.fetch.here > 0) && (
        <Progress name={name} here={kept.fetch.here} bytes={kept.bytes} />
      )}
      {kept.fetch?.failed && <p className="on-robot-failed">Not fetched: {kept.fetch.failed}.</p>}
      {refusal !== null && <p className="on-robot-failed">{refusal}</p>}
      {isComing ? (
        <Button
          kind="quiet"
          icon={<X size={13} />}
          disabled={missing !== null}
          onClick={() => send("DELETE")}
        >
          Cancel
        </Button>
      ) : (
        <Button
          kind="quiet"
          icon={<Download size={13} />}
          disabled={missing !== null || kept.link_bytes === null}
          title={missing ?? undefined}
          onClick={() => send("POST")}
        >
          {kept.fetch && kept.fetch.here > 0 ? "Fetch the rest" : "Fetch all of it"}
        </Button>
      )}
    </div>
  );
}

function Progress({ name, here, bytes }: { name: string; here: number; bytes: number }) {
  return (
    <div className="on-robot-progress">
      <progress value={here} max={bytes} aria-label={`${name}: how much is here`} />
      <span>
        {dataSize(here)} of {dataSize(bytes)}
      </span>
    </div>
  );
}

/** Text about the displayed part, the location of the rest, and the cost of a transfer. */
function words({ bytes, link_bytes, takes_ms, fetch }: OnRobot): string {
  const where = `Shown in part: all ${dataSize(bytes)} are on the robot.`;
  if (link_bytes === null) return `${where} This server does not receive that robot.`;
  if (fetch && fetch.failed === null) {
    const rest = takes_ms === null ? null : (takes_ms * (bytes - fetch.here)) / Math.max(1, bytes);
    if (rest === null) return `${where} On its way: it continues once the robot responds.`;
    return `${where} On its way, behind all else: about ${duration(rest)} left.`;
  }
  const left = 1 - (fetch?.here ?? 0) / Math.max(1, bytes);
  const what = left < 1 ? "Fetching the rest" : "Fetching";
  const cost = `${what} costs ${dataSize(link_bytes * left)} of the link`;
  if (takes_ms === null) return `${where} ${cost}; no signal from the robot.`;
  return `${where} ${cost}, about ${duration(takes_ms * left)} at its rate now.`;
}
