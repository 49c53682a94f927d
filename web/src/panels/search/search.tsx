/** Search in the active machine or in all open ones. A result is shown on the canvas. */

import { type Signal, signal } from "@preact/signals-core";
import { SearchX, Search as Sign } from "lucide-react";
import {
  type KeyboardEvent,
  type ReactNode,
  useDeferredValue,
  useEffect,
  useMemo,
  useRef,
  useState,
} from "react";
import { namesTo } from "../../model/machine.ts";
import type { SearchField, SearchScope } from "../../model/search.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { scriptLineRevealRequest, searchRevealRequest } from "../../store/page/reveal_requests.ts";
import { Empty } from "../../ui/empty.tsx";
import { Checkbox, TextField } from "../../ui/field.tsx";
import { Marked } from "../../ui/marked.tsx";
import { useSignal } from "../../ui/signals.ts";
import { Tree } from "../../ui/tree.tsx";
import { type PanelHost, useActiveTab, useHost } from "../context.tsx";
import { goTo } from "../go_to.ts";
import { KIND_ICONS } from "../kinds.ts";
import { resultsIn, type SearchResult, SHOWN_MAX } from "./results.ts";
import "./search.css";

interface SearchRequest {
  readonly text: string;
  readonly scope: SearchScope | null;
  readonly everywhere: boolean;
}

/** Last search. It survives closing the panel. */
const REQUEST: Signal<SearchRequest> = signal({ text: "", scope: null, everywhere: false });

const SCOPES: readonly (readonly [SearchScope | null, string])[] = [
  [null, "All"],
  ["names", "Names"],
  ["ports", "Ports"],
  ["scripts", "Scripts"],
  ["descriptions", "Descriptions"],
  ["values", "Values"],
  ["libraries", "Libraries"],
];

export function Search() {
  const host = useHost();
  const { page } = host.context();
  const active = useActiveTab();
  const open = useSignal(page.tabs);
  const request = useSignal(REQUEST);
  const text = useDeferredValue(request.text);
  const place = useRef<HTMLDivElement>(null);
  useKeyboard(place);
  const tabs = useMemo(
    () => (request.everywhere ? open : active ? [active] : []),
    [request.everywhere, open, active],
  );
  const version = useVersions(tabs);
  // biome-ignore lint/correctness/useExhaustiveDependencies: machines are mutable objects; their versions change with them
  const found = useMemo(
    () => resultsIn(tabs, text, request.scope),
    [tabs, text, request.scope, version],
  );
  const change = (more: Partial<SearchRequest>) => {
    REQUEST.value = { ...REQUEST.peek(), ...more };
  };
  const [first] = found.results;
  const keys = (event: KeyboardEvent<HTMLElement>) => {
    if (event.key === "Enter" && first) show(host, first);
    else if (event.key !== "ArrowDown") return;
    event.preventDefault();
    place.current?.querySelector<HTMLElement>("[role=tree]")?.focus();
  };
  return (
    <div className="search" ref={place}>
      <div className="search-bar">
        <TextField
          label="Search"
          hideLabel
          type="search"
          placeholder="Names, ports, scripts, values…"
          value={request.text}
          onInput={(text) => change({ text })}
          onKeyDown={keys}
          autoFocus
        />
        <Scopes scope={request.scope} onChange={(scope) => change({ scope })} />
        {open.length > 1 && (
          <Checkbox
            label="In all open machines"
            checked={request.everywhere}
            onChange={(everywhere) => change({ everywhere })}
          />
        )}
      </div>
      <List results={found.results} total={found.total} text={text} several={tabs.length > 1} />
    </div>
  );
}

/** Focuses the input when the search command runs. */
function useKeyboard(place: { readonly current: HTMLElement | null }): void {
  const asked = useSignal(searchRevealRequest);
  useEffect(() => {
    if (asked === 0) return;
    const input = place.current?.querySelector("input");
    input?.focus();
    input?.select();
  }, [asked, place]);
}

/** Counter that changes whenever one of the machines changes. */
function useVersions(tabs: readonly OpenTab[]): number {
  const [version, setVersion] = useState(0);
  useEffect(() => {
    const stops = tabs.map((tab) => tab.session.onChange(() => setVersion((before) => before + 1)));
    return () => {
      for (const stop of stops) stop();
    };
  }, [tabs]);
  return version;
}

interface ScopesProps {
  readonly scope: SearchScope | null;
  readonly onChange: (scope: SearchScope | null) => void;
}

function Scopes({ scope, onChange }: ScopesProps) {
  return (
    <fieldset className="search-scopes">
      <legend className="visually-hidden">Search in</legend>
      {SCOPES.map(([value, title]) => (
        <button
          key={title}
          type="button"
          className="search-scope"
          aria-pressed={value === scope}
          onClick={() => onChange(value)}
        >
          {title}
        </button>
      ))}
    </fieldset>
  );
}

interface ResultListProps {
  readonly results: readonly SearchResult[];
  readonly total: number;
  readonly text: string;
  readonly several: boolean;
}

const NONE: ReadonlySet<string> = new Set();
const ROW_PX = 40;

function List({ results, total, text, several }: ResultListProps) {
  const host = useHost();
  const [chosen, setChosen] = useState<string | null>(null);
  const hovered = useRef<OpenTab | null>(null);
  if (text.trim() === "") {
    return (
      <Empty
        icon={<Sign size={22} />}
        title="Search everywhere"
        text="The search covers names, ids, descriptions, scripts, ports, types, values and libraries as you type. Press Enter to go to a result."
      />
    );
  }
  if (results.length === 0) {
    return (
      <Empty
        icon={<SearchX size={22} />}
        title="Nothing found"
        text={`“${text}” was not found here. Try fewer words, or search everywhere.`}
      />
    );
  }
  const preview = (result: SearchResult | null) => {
    const before = hovered.current;
    if (before && before !== result?.tab) before.view.hovered.value = null;
    hovered.current = result?.tab ?? null;
    if (result) result.tab.view.hovered.value = result.hit.element;
  };
  return (
    <>
      <output className="search-count">{countInWords(total)}</output>
      <Tree
        label="Search results"
        roots={results}
        id={({ key }) => key}
        childrenOf={() => null}
        expanded={NONE}
        onExpand={() => undefined}
        text={inWords}
        row={(result) => <Row result={result} several={several} />}
        rowHeight={ROW_PX}
        selected={new Set(chosen === null ? [] : [chosen])}
        onSelect={(result) => {
          setChosen(result.key);
          show(host, result);
        }}
        onOpen={(result) => {
          show(host, result);
          host.context().canvas?.focus();
        }}
        onHover={preview}
      />
    </>
  );
}

function countInWords(total: number): string {
  const places = `${total.toLocaleString("en")} ${total === 1 ? "place" : "places"}`;
  return total > SHOWN_MAX ? `${places}, the best ${SHOWN_MAX} of them` : places;
}

function show(host: PanelHost, { tab, hit }: SearchResult): void {
  if (hit.field === "script" && hit.line !== null) {
    scriptLineRevealRequest.value = { path: hit.element.path, line: hit.line };
  }
  goTo(host, tab, hit.element);
}

const WORDS: Readonly<Record<SearchField, string>> = {
  name: "",
  id: "id",
  description: "description",
  script: "script",
  outcome: "outcome",
  input: "input",
  output: "output",
  scoped_variable: "scoped variable",
  type: "type of port",
  value: "value",
  library: "library",
  "semantic data": "semantic data",
};

function inWords({ tab, hit }: SearchResult): string {
  const { machine } = tab.session;
  const state = machine.state(hit.element.path)?.name ?? "";
  return hit.field === "name" ? state : `${WORDS[hit.field]} ${hit.text}, ${state}`;
}

function Row({
  result,
  several,
}: {
  readonly result: SearchResult;
  readonly several: boolean;
}): ReactNode {
  const { tab, hit } = result;
  const { machine } = tab.session;
  const state = machine.state(hit.element.path);
  if (!state) return null;
  const Icon = KIND_ICONS[state.kind];
  const names = namesTo(machine, hit.element.path);
  const around = hit.field === "name" ? names.slice(0, -1) : names;
  const line = hit.line === null ? "" : ` ${hit.line}`;
  const what = WORDS[hit.field] === "" ? "" : `${WORDS[hit.field]}${line} · `;
  const where = several || around.length > 1 ? around : around.slice(-1);
  return (
    <span className="search-row" title={`${hit.text}\n${names.join(" / ")}`}>
      <Icon size={14} aria-hidden />
      <span className="search-lines">
        <span className={hit.field === "script" ? "search-text search-code" : "search-text"}>
          <Marked text={hit.text} spans={hit.spans} />
        </span>
        <span className="search-where">
          {what}
          {where.join(" / ")}
        </span>
      </span>
    </span>
  );
}
