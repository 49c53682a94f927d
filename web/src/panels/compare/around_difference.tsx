/** Events around the point where two runs differ on a branch, side by side. */

import type { Happened, Parting } from "../../model/generated/protocol.ts";
import type { Watch } from "../../store/history/run.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { missionTime } from "../../store/page/times.ts";
import { useSignal } from "../../ui/signals.ts";
import { useHost } from "../context.tsx";
import { happenedInWords, namesOf } from "../parts/happened.ts";
import { entriesAround } from "./around.ts";
import type { ComparedSide, ShowCompared } from "./show.ts";

interface AroundDifferenceProps {
  readonly tab: OpenTab;
  readonly watch: Watch;
  readonly other: string;
  readonly parted: Parting;
  readonly show: ShowCompared;
}

export function AroundDifference({ tab, watch, other, parted, show }: AroundDifferenceProps) {
  const { page } = useHost().context();
  const theirs = page.runs.watch(other);
  const of = { tab, branch: parted.branch, show };
  return (
    <div className="compare-sides">
      <Column {...of} side="one" title="This run" watch={watch} at={parted.one} />
      <Column {...of} side="other" title="Other run" watch={theirs} at={parted.other} />
    </div>
  );
}

interface ColumnProps {
  readonly tab: OpenTab;
  readonly branch: string;
  readonly side: ComparedSide;
  readonly title: string;
  readonly watch: Watch;
  readonly at: Happened | null;
  readonly show: ShowCompared;
}

function Column({ tab, branch, side, title, watch, at, show }: ColumnProps) {
  useSignal(watch.journalVersion);
  useSignal(tab.session.version);
  const nameOf = namesOf(tab.session);
  useSignal(watch.playhead);
  const sequence = at?.sequence ?? watch.journal.next - 1;
  const journal = [watch.journal, watch.window].find((each) => each.covers(sequence));
  return (
    <div className="compare-column">
      <h4 className={`compare-side compare-side-${side}`}>{title}</h4>
      <ol aria-label={`${title}, around the difference`}>
        {(journal ? entriesAround(journal, branch, at?.sequence ?? null) : []).map((index) => {
          const entry = journal?.at(index);
          if (!entry) return null;
          const isIt = entry.sequence === at?.sequence;
          return (
            <li key={index}>
              <button
                type="button"
                className={`compare-event ${isIt ? "compare-parted" : ""}`}
                aria-label={`${isIt ? "Runs diverge here: " : ""}${happenedInWords(entry, nameOf)}, in ${title.toLowerCase()}`}
                onClick={() => show(side, entry.sequence)}
              >
                <span className="compare-mark" aria-hidden>
                  {isIt ? "≠" : ""}
                </span>
                <span className="compare-what">{happenedInWords(entry, nameOf)}</span>
                <span className="compare-when">{missionTime(entry.t_ns)}</span>
              </button>
            </li>
          );
        })}
        {watch.journal.length === 0 && <li className="compare-soft">Loading events…</li>}
        {watch.journal.length > 0 && at && !journal && (
          <li>
            <button type="button" className="compare-event" onClick={() => show(side, sequence)}>
              <span className="compare-what">Show the events around this place</span>
              <span className="compare-when">{missionTime(at.t_ns)}</span>
            </button>
          </li>
        )}
        {at === null && (
          <li className="compare-event compare-parted">
            <span className="compare-mark" aria-hidden>
              ≠
            </span>
            No further events here
          </li>
        )}
      </ol>
    </div>
  );
}
