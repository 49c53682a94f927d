/** History of the run: its calls as a tree, each with start, duration and outcome. A selected call is shown on the canvas, at its
 * moment. */

import {
  ArrowDown,
  ArrowUp,
  ArrowUpToLine,
  CornerDownRight,
  ListEnd,
  Repeat,
  Undo2,
} from "lucide-react";
import { useEffect, useMemo, useState } from "react";
import { entryOf as entryOfCommand } from "../../commands/menus.ts";
import { callAbout } from "../../store/history/about.ts";
import { type Calls, callsOf, NONE } from "../../store/history/calls.ts";
import { errorInWords } from "../../store/history/failures.ts";
import type { JournalEntry } from "../../store/history/journal.ts";
import { hasFailed, lookOf } from "../../store/history/lanes.ts";
import { shownIndex, toEnd } from "../../store/history/moments.ts";
import type { Watch } from "../../store/history/run.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { runTime, runTimes, timeScale } from "../../store/page/times.ts";
import { select } from "../../store/page/view.ts";
import { RunSearch } from "../../store/run/search.ts";
import { IconButton } from "../../ui/button.tsx";
import { Empty } from "../../ui/empty.tsx";
import { TextField } from "../../ui/field.tsx";
import { ContextMenu } from "../../ui/menu.tsx";
import { useSignal } from "../../ui/signals.ts";
import { Tree } from "../../ui/tree.tsx";
import { useHost } from "../context.tsx";
import { measured } from "../parts/duration.ts";
import { forRun, type RunPanelProps } from "../parts/for_tab.tsx";
import { happenedInWords, type NameOf, namesOf } from "../parts/happened.ts";
import { reveal } from "../reveal.ts";
import { ends, type HistoryNode, lengthOf, Nodes, timesOf } from "./nodes.ts";
import "./history.css";

export const RunHistory = forRun(
  RunHistoryOfRun,
  "Its calls appear here.",
  "The calls of its runs appear here.",
);

function RunHistoryOfRun({ tab, watch }: RunPanelProps) {
  const [query, setQuery] = useState("");
  const [menu, setMenu] = useState<HistoryMenu | null>(null);
  useSignal(watch.journalVersion);
  useSignal(watch.playhead);
  useSignal(tab.session.version);
  const show = useShow(tab, watch);
  const open = (sequence: number, at: HistoryMenu["at"]) => setMenu({ sequence, at });
  return (
    <section className="history" aria-label="Run history">
      <div className="history-bar">
        <TextField
          label="Search the history: states, outcomes, log"
          hideLabel
          type="search"
          placeholder="State, outcome, text"
          value={query}
          onInput={setQuery}
        />
        <Part watch={watch} />
      </div>
      <div className="history-rows">
        {query.trim() === "" ? (
          <CallTree key={watch.window.from} tab={tab} watch={watch} show={show} onMenu={open} />
        ) : (
          <Hits tab={tab} watch={watch} query={query} show={show} onMenu={open} />
        )}
      </div>
      {menu && <Menu {...menu} tab={tab} watch={watch} onClose={() => setMenu(null)} />}
    </section>
  );
}

/** Loaded part of a long run, and buttons for the rest. */
function Part({ watch }: Pick<RunPanelProps, "watch">) {
  const { window, journal, playhead } = watch;
  const last = (journal.next - 1).toLocaleString("en");
  if (journal.base === null) {
    return <span className="history-soft">{journal.length.toLocaleString("en")} events</span>;
  }
  const [from, to] = [window.from.toLocaleString("en"), (window.next - 1).toLocaleString("en")];
  return (
    <>
      <span className="history-soft" role="status">
        Events {from} to {to} of {last}
      </span>
      <span className="history-ways">
        <IconButton
          label="Show the first events"
          icon={<ArrowUpToLine size={14} />}
          disabled={window.base === null}
          onClick={() => toEnd(watch, "first")}
        />
        <IconButton
          label="Show earlier events"
          icon={<ArrowUp size={14} />}
          disabled={window.base === null}
          onClick={() => {
            playhead.value = Math.max(1, window.from - 1);
          }}
        />
        <IconButton
          label="Show later events"
          icon={<ArrowDown size={14} />}
          disabled={window === journal}
          onClick={() => {
            playhead.value = window.next < journal.next ? window.next : null;
          }}
        />
      </span>
    </>
  );
}

/** Shows the moment of an event, and selects its state. With `far` it also moves the state into view. */
type ShowEntry = (sequence: number, path: string, far?: boolean) => void;

function useShow(tab: OpenTab, watch: Watch): ShowEntry {
  const host = useHost();
  return (sequence, path, far = false) => {
    watch.playhead.value = sequence;
    if (path === "" || !tab.session.machine.state(path)) return;
    if (far) reveal(host, { kind: "state", path });
    else select(tab.view, [{ kind: "state", path }]);
  };
}

function pathIn(entry: JournalEntry | undefined): string {
  if (!entry) return "";
  if (entry.kind !== "other") return entry.path;
  return "path" in entry.event ? entry.event.path : "";
}

interface HistoryMenu {
  /** Sequence number of the event that the menu is about. */
  readonly sequence: number;
  readonly at: { readonly x: number; readonly y: number };
}

interface HistoryListProps extends RunPanelProps {
  readonly show: ShowEntry;
  readonly onMenu: (sequence: number, at: HistoryMenu["at"]) => void;
}

function CallTree({ tab, watch, show, onMenu }: HistoryListProps) {
  const calls = callsOf(watch.window);
  const nodes = useMemo(() => new Nodes(calls), [calls]);
  const [expanded, setExpanded] = useState<ReadonlySet<string>>(() => new Set(["c0"]));
  const [chosen, setChosen] = useState<HistoryNode | null>(null);
  const playhead = useSignal(watch.playhead);
  const journalVersion = calls.read;
  const isLoading = playhead === null || !watch.window.covers(playhead);
  const shown = isLoading ? NONE : callAbout(calls, shownIndex(watch));
  // A selection in this list is visible already. A loop must not open when its first call is shown.
  const isHere = chosen !== null && ends(chosen).first === shown;
  useEffect(() => {
    if (shown === NONE || isHere) return;
    setExpanded((before) => new Set([...before, ...nodes.ancestors(shown)]));
  }, [shown, isHere, nodes]);
  // biome-ignore lint/correctness/useExhaustiveDependencies: nodes read calls that grow
  const roots = useMemo(() => nodes.roots(), [nodes, journalVersion]);
  // biome-ignore lint/correctness/useExhaustiveDependencies: nodes read calls that grow
  const childrenOf = useMemo(
    () => (node: HistoryNode) => nodes.inside(node),
    [nodes, journalVersion],
  );
  const nameOf = namesOf(tab.session);
  const at = shown === NONE ? null : isHere ? chosen.id : `c${shown}`;
  const begin = (node: HistoryNode) => watch.window.sequence(calls.begin(ends(node).first));
  const pathOf = (node: HistoryNode) => calls.path(ends(node).first);
  return (
    <>
      <Head />
      <Tree<HistoryNode>
        label="Calls of the run, in order"
        roots={roots}
        id={idOfNode}
        childrenOf={childrenOf}
        expanded={expanded}
        onExpand={(node, open) => setExpanded((before) => toggled(before, node.id, open))}
        text={(node) => nameOfNode(node, calls, nameOf)}
        row={(node) => <Row watch={watch} node={node} calls={calls} nameOf={nameOf} />}
        selected={new Set(at === null ? [] : [at])}
        reveal={at}
        onSelect={(node) => {
          setChosen(node);
          show(begin(node), pathOf(node));
        }}
        onOpen={(node) => show(begin(node), pathOf(node), true)}
        onMenu={(node, at) => onMenu(begin(node), at)}
      />
    </>
  );
}

/** Titles of the columns. */
function Head() {
  return (
    <div className="history-head" aria-hidden>
      <span className="history-name">State</span>
      <span className="history-when">Began</span>
      <span className="history-long">Took</span>
      <span className="history-end">Outcome</span>
    </div>
  );
}

function idOfNode({ id }: HistoryNode): string {
  return id;
}

function toggled(before: ReadonlySet<string>, id: string, open: boolean): ReadonlySet<string> {
  const after = new Set(before);
  if (open) after.add(id);
  else after.delete(id);
  return after;
}

/** Maximum number of names in the title of a loop. */
const NAMES_MAX = 4;

function nameOfNode(node: HistoryNode, calls: Calls, nameOf: NameOf): string {
  const name = (call: number) => nameOf(calls.path(call));
  switch (node.kind) {
    case "call":
      return name(node.call);
    case "part":
      return `${node.from} to ${node.to}`;
    case "round":
      return `Round ${node.number}`;
    case "loop": {
      const names = node.calls.slice(0, Math.min(node.period, NAMES_MAX)).map(name);
      const more = node.period > NAMES_MAX ? ", …" : "";
      return `${names.join(", ")}${more} × ${timesOf(node, calls)}`;
    }
  }
}

interface HistoryRowProps {
  readonly watch: Watch;
  readonly node: HistoryNode;
  readonly calls: Calls;
  readonly nameOf: NameOf;
}

function Row({ watch, node, calls, nameOf }: HistoryRowProps) {
  useSignal(timeScale);
  const { first, last } = ends(node);
  const began = calls.began_ns(first);
  return (
    <span className="history-row">
      <Icon node={node} calls={calls} />
      <span className="history-name">{nameOfNode(node, calls, nameOf)}</span>
      <span className="history-when" title={runTimes(watch, began)}>
        {runTime(watch, began)}
      </span>
      <span className="history-long">{measured(lengthOf(node, calls) / 1e6)}</span>
      <End call={last} calls={calls} />
    </span>
  );
}

function Icon({ node, calls }: Pick<HistoryRowProps, "node" | "calls">) {
  if (node.kind === "loop") return <Repeat size={13} aria-label="loop" />;
  if (node.kind !== "call") return <ListEnd size={13} aria-hidden />;
  if (calls.isBack(node.call)) return <Undo2 size={13} aria-label="step back" />;
  const around = calls.parent(node.call);
  const isBranch = around !== NONE && calls.concurrent.has(calls.pathNumber(around));
  return isBranch ? <CornerDownRight size={13} aria-label="branch" /> : null;
}

/** Outcome of a call, as text, icon and colour. */
function End({ call, calls }: { readonly call: number; readonly calls: Calls }) {
  const kind = lookOf(calls, call);
  const isBad = hasFailed(calls, call);
  const words = {
    open: "● active",
    back: "↶ undone",
    dropped: "⇥ interrupted",
    aborted: "✕ aborted",
    preempted: "⊘ preempted",
    ended: calls.outcome(call)?.name ?? "",
  }[kind];
  const error = isBad ? errorInWords(calls.journal.error(calls.end(call))) : "";
  return (
    <span
      className={`history-end history-${isBad ? "aborted" : kind} ${kind === "open" ? "shows-run" : ""}`}
      title={error === "" ? words : `${words}: ${error}`}
    >
      {isBad && kind !== "aborted" ? `✕ ${words}` : words}
    </span>
  );
}

function Hits({ tab, watch, query, show, onMenu }: HistoryListProps & { readonly query: string }) {
  const nameOf = namesOf(tab.session);
  const { page } = useHost().context();
  // biome-ignore lint/correctness/useExhaustiveDependencies: names change only with the machine
  const found = useMemo(
    () => new RunSearch(watch, page.runs, query, namesOf(tab.session)),
    [watch, page, query, tab.session.version.peek()],
  );
  useEffect(() => () => found.end(), [found]);
  useSignal(found.changed);
  found.follow();
  const { count } = found;
  const roots = useMemo(() => Array.from({ length: count }, (_, place) => place), [count]);
  if (count === 0) {
    if (found.refusal !== null) return <Empty title="The search failed" text={found.refusal} />;
    if (found.isAsking) return <Empty title="Searching…" text="The whole run is searched." />;
    return <Empty title="Nothing found" text="The search covers states, outcomes and log lines." />;
  }
  const shown = shownPlace(watch, found);
  const words = (place: number) => {
    const entry = found.at(place);
    return entry ? happenedInWords(entry, nameOf) : "no longer loaded";
  };
  return (
    <Tree<number>
      label="Search results in the run"
      roots={roots}
      id={String}
      childrenOf={() => null}
      expanded={NOTHING}
      onExpand={() => undefined}
      text={words}
      row={(place) => (
        <span className="history-row">
          <span className="history-name">{words(place)}</span>
          <span className="history-when">{runTime(watch, found.t_ns(place))}</span>
        </span>
      )}
      selected={new Set([String(shown)])}
      onSelect={(place) => show(found.sequence(place), pathIn(found.at(place)))}
      onOpen={(place) => show(found.sequence(place), pathIn(found.at(place)), true)}
      onMenu={(place, at) => onMenu(found.sequence(place), at)}
    />
  );
}

const NOTHING: ReadonlySet<string> = new Set();

/** Index of the hit at the shown moment; NONE if there is no such hit. */
function shownPlace(watch: Watch, found: RunSearch): number {
  const playhead = watch.playhead.peek();
  if (playhead === null) return NONE;
  const place = found.after(playhead - 1);
  return found.sequence(place) === playhead ? place : NONE;
}

function Menu({
  sequence: of,
  at,
  tab,
  watch,
  onClose,
}: HistoryMenu & RunPanelProps & { onClose: () => void }) {
  const host = useHost();
  const context = host.context();
  const { window } = watch;
  const calls = callsOf(window);
  const index = window.timeOf(of) === null ? NONE : window.indexOf(of);
  const call = index === NONE ? NONE : callAbout(calls, index);
  const end = call === NONE ? NONE : calls.end(call);
  const sequence = window.sequence(calls.begin(call));
  const path = index === NONE ? "" : pathIn(window.at(index));
  const show = (event: number) => {
    watch.playhead.value = event;
  };
  const refusal = host.commands.refusalOf("run.start-from-history", context);
  const compare = host.commands.get("run.compare");
  return (
    <ContextMenu
      label="Actions for this event"
      at={at}
      onClose={onClose}
      items={[
        { id: "show", title: "Show this moment", run: () => show(of) },
        {
          id: "end",
          title: "Show the moment it ended",
          disabled: end === NONE,
          run: () => show(window.sequence(end)),
        },
        {
          id: "reveal",
          title: "Show the state on the canvas",
          disabled: !tab.session.machine.state(path),
          run: () => reveal(host, { kind: "state", path }),
        },
        "separator",
        {
          id: "start",
          title: "Start from here",
          disabled: refusal !== null || call === NONE,
          ...(refusal === null ? {} : { detail: refusal }),
          run: () => void host.commands.run("run.start-from-history", context, sequence),
        },
        ...(compare
          ? [entryOfCommand({ commands: host.commands, context, keys: () => [] }, compare)]
          : []),
      ]}
    />
  );
}
