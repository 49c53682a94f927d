/** Values that an engineer watches of this machine, as they are at the moment that is shown; what is not at hand has a dash. */

import { useEffect } from "react";
import { readExpression } from "../../model/expression.ts";
import { shortValue } from "../../model/short_value.ts";
import { type OpenTab, runOf } from "../../store/page.ts";
import type { Watch } from "../../store/run.ts";
import { pictureOf, standingOf } from "../../store/standing.ts";
import { type Target, type Watched, watchedOf } from "../../store/watched_values.ts";
import { useComputed } from "../../ui/signals.ts";
import { useActiveTab, useHost } from "../context.tsx";

export function Pinned({ watch }: { readonly watch: Watch }) {
  const tab = useActiveTab();
  const { page } = useHost().context();
  const isOf = useComputed(() => runOf(page) === watch, [page, watch]);
  return tab && isOf ? <List tab={tab} watch={watch} /> : null;
}

function List({ tab, watch }: { readonly tab: OpenTab; readonly watch: Watch }) {
  const lines = useComputed(
    () => JSON.stringify(watchedOf(tab).value.map((each) => [nameOf(each), told(watch, each)])),
    [tab, watch],
  );
  const all = JSON.parse(lines) as readonly (readonly [string, string])[];
  const isWanted = all.length > 0;
  useEffect(() => (isWanted ? watch.wantValues() : undefined), [watch, isWanted]);
  if (!isWanted) return null;
  return (
    <section className="mission-part" aria-label="Watched values">
      <dl className="mission-pinned shows-run">
        {all.map(([name, value], at) => (
          // biome-ignore lint/suspicious/noArrayIndexKey: a line is its place
          <div key={at}>
            <dt>{name}</dt>
            <dd>{value}</dd>
          </div>
        ))}
      </dl>
    </section>
  );
}

function nameOf({ target, expression }: Watched): string {
  return expression === "value" ? target.name : `${target.name}: ${expression}`;
}

function told(watch: Watch, { target, expression }: Watched): string {
  const value = valueAt(watch, target);
  if (value === undefined) return "–";
  const read = readExpression(expression);
  if ("refused" in read) return "–";
  const worked = read.of(value);
  return "refused" in worked ? "–" : shortValue(worked.value);
}

function valueAt(watch: Watch, { kind, path, name }: Target): unknown {
  if (kind === "global") return pictureOf(watch)?.globals[name];
  const { scoped, inputs, outputs } = standingOf(watch, path);
  if (kind === "scoped_variable") return scoped?.[name];
  return kind === "input" ? inputs?.[name] : outputs?.[name];
}
