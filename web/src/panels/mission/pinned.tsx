/** Values of this machine that an engineer watches, as of the shown moment, each with its time. */

import { readExpression } from "../../model/expression.ts";
import { shortValue } from "../../model/short_value.ts";
import type { Watch } from "../../store/history/run.ts";
import { type OpenTab, runOf } from "../../store/page/page.ts";
import { type WatchedExpression, watchedOf } from "../../store/run/watched_values.ts";
import { useComputed } from "../../ui/signals.ts";
import { useActiveTab, useHost } from "../context.tsx";
import { growing } from "../parts/duration.ts";
import { useValue, type ValueNow } from "../parts/value/use_value.ts";
import { useWhen } from "./when.ts";

export function Pinned({ watch }: { readonly watch: Watch }) {
  const tab = useActiveTab();
  const { page } = useHost().context();
  const isOf = useComputed(() => runOf(page) === watch, [page, watch]);
  return tab && isOf ? <List tab={tab} watch={watch} /> : null;
}

function List({ tab, watch }: { readonly tab: OpenTab; readonly watch: Watch }) {
  const all = useComputed(() => watchedOf(tab).value, [tab]);
  if (all.length === 0) return null;
  return (
    <section className="mission-part" aria-label="Watched values">
      <dl className="mission-pinned shows-run">
        {all.map((watched) => (
          <Value key={watched.id} tab={tab} watch={watch} watched={watched} />
        ))}
      </dl>
    </section>
  );
}

interface ValueProps {
  readonly tab: OpenTab;
  readonly watch: Watch;
  readonly watched: WatchedExpression;
}

function Value({ tab, watch, watched }: ValueProps) {
  const { page } = useHost().context();
  const now = useValue(page, tab, watch, watched.target);
  const text = valueInWords(now, watched.expression);
  return (
    <div>
      <dt>{nameOf(watched)}</dt>
      <dd title={now.state === "none" ? now.why : text}>{text}</dd>
      {now.state === "there" && now.sequence !== null && (
        <Age watch={watch} t_ns={now.aheadAt_ns ?? timeOf(watch, now.sequence)} />
      )}
    </div>
  );
}

/** Time of the value: its age, or for an earlier moment the time since the start. */
function Age({ watch, t_ns }: { readonly watch: Watch; readonly t_ns: number }) {
  const t_ms = t_ns / 1e6;
  const isPast = useComputed(() => watch.playhead.value !== null, [watch]);
  const when = useWhen(watch, t_ms);
  return <dd className="mission-pinned-when">{isPast ? `after ${growing(t_ms)}` : when}</dd>;
}

function timeOf({ window }: Watch, sequence: number): number {
  return window.t_ns(window.indexOf(sequence));
}

function nameOf({ target, expression }: WatchedExpression): string {
  return expression === "value" ? target.name : `${target.name}: ${expression}`;
}

/** Text of a value, or a dash if it is unavailable or cannot be computed. */
function valueInWords(now: ValueNow, expression: string): string {
  if (now.state !== "there") return "–";
  const read = readExpression(expression);
  if ("refused" in read) return "–";
  const worked = read.of(now.value);
  return "refused" in worked ? "–" : shortValue(worked.value);
}
