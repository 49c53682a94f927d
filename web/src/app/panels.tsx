/** The dockable panels: their names, initial places, and the counters of their tabs. */

import {
  Activity,
  Braces,
  ChartBar,
  ChartGantt,
  CircleAlert,
  CircleDot,
  Eye,
  GitCompare,
  GitCompareArrows,
  History,
  Library,
  ListOrdered,
  ListTree,
  ListVideo,
  type LucideIcon,
  Radar,
  Route,
  ScrollText,
  Search as SearchSign,
  SlidersHorizontal,
} from "lucide-react";
import type { FunctionComponent } from "react";
import type { PanelSide } from "../commands/command.ts";
import { countProblems } from "../model/problem.ts";
import { Mission } from "../panels/mission/mission.tsx";
import { Timeline } from "../panels/timeline/timeline.tsx";
import type { OpenTab } from "../store/page/page.ts";
import { countUnacknowledged } from "../store/run/acknowledged.ts";
import { breakpointsOf } from "../store/run/breakpoints.ts";
import { type OnDemand, onDemand } from "../ui/on_demand.tsx";

// Panels of mission control are loaded with the page, the others when they are first shown.
const Breakpoints = onDemand(
  async () => (await import("../panels/breakpoints/breakpoints.tsx")).Breakpoints,
);
const Compare = onDemand(async () => (await import("../panels/compare/compare.tsx")).Compare);
const Differences = onDemand(
  async () => (await import("../panels/differences/differences.tsx")).Differences,
);
const Edits = onDemand(async () => (await import("../panels/edits/edits.tsx")).Edits);
const Globals = onDemand(async () => (await import("../panels/globals/globals.tsx")).Globals);
const Inspector = onDemand(
  async () => (await import("../panels/inspector/inspector.tsx")).Inspector,
);
const Libraries = onDemand(
  async () => (await import("../panels/libraries/libraries.tsx")).Libraries,
);
const Log = onDemand(async () => (await import("../panels/log/log.tsx")).Log);
const PlannerPanel = onDemand(
  async () => (await import("../panels/planner/planner.tsx")).PlannerPanel,
);
const Problems = onDemand(async () => (await import("../panels/problems/problems.tsx")).Problems);
const RunHistory = onDemand(async () => (await import("../panels/history/history.tsx")).RunHistory);
const Running = onDemand(async () => (await import("../panels/running/running.tsx")).Running);
const Runs = onDemand(async () => (await import("../panels/runs/runs.tsx")).Runs);
const Search = onDemand(async () => (await import("../panels/search/search.tsx")).Search);
const Statistics = onDemand(
  async () => (await import("../panels/statistics/statistics.tsx")).Statistics,
);
const StateTree = onDemand(async () => (await import("../panels/tree/tree.tsx")).StateTree);
const Watches = onDemand(async () => (await import("../panels/watches/watches.tsx")).Watches);

export interface Panel {
  readonly id: string;
  readonly title: string;
  readonly icon: LucideIcon;
  readonly component: FunctionComponent;
  /** Default side. */
  readonly side: PanelSide;
  /** Number of items that need attention. */
  readonly count?: (tab: OpenTab | null) => number;
  /** True if values can be dropped there. Dragging one over the tab shows the panel. */
  readonly takesValues?: boolean;
}

export const PANELS: readonly Panel[] = [
  { id: "libraries", title: "Libraries", icon: Library, component: Libraries, side: "left" },
  { id: "tree", title: "Tree", icon: ListTree, component: StateTree, side: "left" },
  { id: "search", title: "Search", icon: SearchSign, component: Search, side: "left" },
  { id: "globals", title: "Globals", icon: Braces, component: Globals, side: "left" },
  {
    id: "breakpoints",
    title: "Breakpoints",
    icon: CircleDot,
    component: Breakpoints,
    side: "left",
    count: (tab) => (tab ? breakpointsOf(tab).length : 0),
  },
  { id: "running", title: "Running", icon: Activity, component: Running, side: "left" },
  { id: "runs", title: "Runs", icon: ListVideo, component: Runs, side: "left" },
  {
    id: "inspector",
    title: "Inspector",
    icon: SlidersHorizontal,
    component: Inspector,
    side: "right",
  },
  { id: "planner", title: "Planner", icon: Route, component: PlannerPanel, side: "right" },
  {
    id: "watches",
    title: "Watches",
    icon: Eye,
    component: Watches,
    side: "right",
    takesValues: true,
  },
  { id: "timeline", title: "Timeline", icon: ChartGantt, component: Timeline, side: "bottom" },
  { id: "history", title: "Run history", icon: ListOrdered, component: RunHistory, side: "bottom" },
  { id: "compare", title: "Compare runs", icon: GitCompare, component: Compare, side: "bottom" },
  {
    id: "mission",
    title: "Mission",
    icon: Radar,
    component: Mission,
    side: "left",
    count: (tab) => countUnacknowledged(tab?.run.value ?? null),
  },
  { id: "statistics", title: "Statistics", icon: ChartBar, component: Statistics, side: "bottom" },
  { id: "log", title: "Log", icon: ScrollText, component: Log, side: "bottom" },
  { id: "edits", title: "Edits", icon: History, component: Edits, side: "bottom" },
  {
    id: "problems",
    title: "Problems",
    icon: CircleAlert,
    component: Problems,
    side: "bottom",
    count: (tab) => (tab ? countProblems(tab.session.problems.value) : 0),
  },
  {
    id: "differences",
    title: "Differences",
    icon: GitCompareArrows,
    component: Differences,
    side: "bottom",
  },
];

/** Panels that are loaded when they are first shown, or while the page is idle. */
export const LATER: readonly OnDemand<never>[] = [
  Log,
  RunHistory,
  Breakpoints,
  Compare,
  Differences,
  Edits,
  Globals,
  Inspector,
  Libraries,
  PlannerPanel,
  Problems,
  Running,
  Runs,
  Search,
  Statistics,
  StateTree,
  Watches,
];

export function panelOf(id: string): Panel | undefined {
  return PANELS.find((panel) => panel.id === id);
}
