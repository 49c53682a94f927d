/** Ways through the time of a run: event by event, from entry to entry of a state, to its begin. */

import { entryOf, shownIndex, stepPlayhead, toEnd, toEntry } from "../store/history/moments.ts";
import type { Watch } from "../store/history/run.ts";
import { runOf } from "../store/page/page.ts";
import { selectedStates } from "../store/page/view.ts";
import type { CommandContext, UserCommand } from "./command.ts";

const NO_RUN = "no run is shown here: start one, or choose one";

export const RUN_TIME: readonly UserCommand[] = [
  {
    id: "run.event-before",
    title: "One event back",
    detail: "Shows the previous moment. The run itself continues.",
    keys: [","],
    menu: "Run/9/Moment",
    refusal: ({ page }) => {
      const watch = runOf(page);
      if (!watch) return NO_RUN;
      return shownIndex(watch) > 0 ? null : "this is the first event";
    },
    run: ({ page }) => stepIn(runOf(page), -1),
  },
  {
    id: "run.event-after",
    title: "One event forward",
    detail: "Shows the next moment. After the last event, shows the current state.",
    keys: ["."],
    menu: "Run/9/Moment",
    refusal: ({ page }) => {
      const watch = runOf(page);
      if (!watch) return NO_RUN;
      return watch.playhead.value === null ? "the current state is already shown" : null;
    },
    run: ({ page }) => stepIn(runOf(page), 1),
  },
  {
    id: "run.entry-before",
    title: "Previous entry of the selected state",
    keys: ["Alt+,"],
    menu: "Run/9/Moment",
    refusal: (context) => refusedEntry(context, "before"),
    run: (context) => goToEntry(context, "before"),
  },
  {
    id: "run.entry-after",
    title: "Next entry of the selected state",
    keys: ["Alt+."],
    menu: "Run/9/Moment",
    refusal: (context) => refusedEntry(context, "after"),
    run: (context) => goToEntry(context, "after"),
  },
  {
    id: "run.first-event",
    title: "Start of the run",
    menu: "Run/9/Moment",
    refusal: ({ page }) => (runOf(page) ? null : NO_RUN),
    run: ({ page }) => {
      const watch = runOf(page);
      if (watch) toEnd(watch, "first");
    },
  },
];

function stepIn(watch: Watch | null, by: number): void {
  if (watch) stepPlayhead(watch, by);
}

function refusedEntry({ page, tab }: CommandContext, direction: "before" | "after"): string | null {
  const watch = runOf(page);
  if (!watch) return NO_RUN;
  const [path] = tab ? selectedStates(tab.view) : [];
  if (path === undefined) return "no state is selected: select a state to go to its entries";
  return entryOf(watch, path, direction) === null
    ? `the state was not entered ${direction} this moment`
    : null;
}

function goToEntry({ page, tab }: CommandContext, direction: "before" | "after"): void {
  const watch = runOf(page);
  const [path] = tab ? selectedStates(tab.view) : [];
  if (watch && path !== undefined) toEntry(watch, path, direction);
}
