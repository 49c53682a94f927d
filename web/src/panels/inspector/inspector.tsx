/** The inspector: everything about what is selected, in one column. Pinned it stays where it is. */

import { ExternalLink, LocateFixed, Pin, PinOff } from "lucide-react";
import { memo, useDeferredValue, useMemo, useState } from "react";
import { type ElementKey, type ElementRef, elementOf } from "../../model/element.ts";
import { nameOf } from "../../model/ends.ts";
import { lineage, parentOf } from "../../model/path.ts";
import { KIND_WORDS } from "../../plan/legal.ts";
import type { OpenTab } from "../../store/page.ts";
import { select } from "../../store/view.ts";
import { Button, IconButton } from "../../ui/button.tsx";
import { Empty } from "../../ui/empty.tsx";
import { useSignal } from "../../ui/signals.ts";
import { useActiveTab, useCommand, useHost } from "../context.tsx";
import { ConnectionView } from "./connection_view.tsx";
import { counted, ELEMENT_ICONS, KIND_ICONS } from "./kinds.ts";
import { MachineView } from "./machine_view.tsx";
import { OutcomeView } from "./outcome_view.tsx";
import { PortView } from "./port_view.tsx";
import { makeEdit, type Seen, type SeenState, seenState } from "./seen.ts";
import { SeveralView } from "./several_view.tsx";
import { StateView } from "./state_view.tsx";
import { pathOf, type Subject, subjectOf } from "./subject.ts";
import "./inspector.css";

/** What the inspector is kept at. */
interface Pinned {
  readonly tab: OpenTab;
  readonly elements: readonly ElementRef[];
}

export function Inspector() {
  const active = useActiveTab();
  const [pinned, setPinned] = useState<Pinned | null>(null);
  const tabs = useSignal(useHost().context().page.tabs);
  const kept = pinned && tabs.includes(pinned.tab) ? pinned : null;
  const tab = kept?.tab ?? active;
  if (!tab) {
    return (
      <Empty
        title="Nothing to inspect"
        text="Open a machine: what you select in it is shown and edited here."
      />
    );
  }
  return <OfTab key={tab.session.id} tab={tab} pinned={kept} onPin={setPinned} />;
}

interface OfTabProps {
  readonly tab: OpenTab;
  readonly pinned: Pinned | null;
  readonly onPin: (pinned: Pinned | null) => void;
}

/** The canvas shows what is selected or edited at once; all this follows without holding it up. */
function OfTab({ tab, pinned, onPin }: OfTabProps) {
  const version = useSignal(tab.session.version);
  const selection = useSignal(tab.view.selection);
  const shown = useMemo(
    () => ({ version, elements: pinned?.elements ?? elementsOf(selection) }),
    [version, selection, pinned],
  );
  return <Shown tab={tab} pinned={pinned} onPin={onPin} {...useDeferredValue(shown)} />;
}

interface ShownProps extends OfTabProps {
  readonly elements: readonly ElementRef[];
  /** Of the machine, which stays the same object: another one is another picture. */
  readonly version: number;
}

const Shown = memo(function Shown({ tab, pinned, onPin, elements }: ShownProps) {
  const seen = useSeen(tab);
  const subject = subjectOf(seen.machine, elements);
  const state = seenState(seen, pathOf(seen.machine, subject));
  if (!state) return null;
  const pin = () => onPin(pinned ? null : { tab, elements });
  return (
    <div className="inspector">
      <Head seen={state} subject={subject} isPinned={pinned !== null} onPin={pin} />
      <div className="inspector-column">
        {seen.machine.isInLibrary(state.path) && <InLibrary seen={state} />}
        <View seen={state} subject={subject} isSelected={pinned === null} />
      </div>
    </div>
  );
});

function elementsOf(selection: ReadonlySet<ElementKey>): readonly ElementRef[] {
  return [...selection].flatMap((key) => elementOf(key) ?? []);
}

/** The machine as it is now, and the ways from here to it. */
function useSeen(tab: OpenTab): Seen {
  const host = useHost();
  const run = useCommand();
  const { page } = host.context();
  useSignal(page.server.link);
  return {
    page,
    tab,
    machine: tab.session.machine,
    run,
    edit: (plan) => makeEdit(page, tab, plan),
    hover: (element) => {
      tab.view.hovered.value = element;
    },
    show: (element) => {
      page.active.value = tab;
      select(tab.view, [element]);
      host.context().canvas?.reveal(element);
    },
  };
}

interface ViewProps {
  readonly seen: SeenState;
  readonly subject: Subject;
  readonly isSelected: boolean;
}

function View({ seen, subject, isSelected }: ViewProps) {
  switch (subject.kind) {
    case "machine":
      return <MachineView seen={seen} />;
    case "state":
      return <StateView seen={seen} />;
    case "port":
      return <PortView seen={seen} port={subject.port} />;
    case "outcome":
      return <OutcomeView seen={seen} id={subject.id} />;
    case "connection":
      return <ConnectionView seen={seen} connection={subject.connection} />;
    case "several":
      return <SeveralView seen={seen} elements={subject.elements} isSelected={isSelected} />;
  }
}

interface HeadProps {
  readonly seen: SeenState;
  readonly subject: Subject;
  readonly isPinned: boolean;
  readonly onPin: () => void;
}

function Head({ seen, subject, isPinned, onPin }: HeadProps) {
  const { state } = seen;
  const element = elementIn(subject);
  const kind = element?.kind ?? "state";
  const Icon = kind === "state" || kind === "income" ? KIND_ICONS[state.kind] : ELEMENT_ICONS[kind];
  return (
    <div className="inspector-head">
      <div className="inspector-title">
        <Icon size={16} aria-hidden />
        <h2 title={titleOf(seen, subject)}>{titleOf(seen, subject)}</h2>
        {element && (
          <IconButton
            label="Show on the canvas"
            icon={<LocateFixed size={15} />}
            onClick={() => seen.show(element)}
          />
        )}
        <IconButton
          label={isPinned ? "Follow the selection again" : "Stay at this"}
          icon={isPinned ? <PinOff size={15} /> : <Pin size={15} />}
          pressed={isPinned}
          onClick={onPin}
        />
      </div>
      {subject.kind !== "machine" && <Way seen={seen} isOfState={subject.kind === "state"} />}
    </div>
  );
}

function titleOf({ machine, state }: SeenState, subject: Subject): string {
  if (subject.kind === "several") return counted(subject.elements.length, "element");
  const element = elementIn(subject);
  return element ? nameOf(machine, element) : state.name;
}

function elementIn(subject: Subject): ElementRef | null {
  switch (subject.kind) {
    case "machine":
    case "several":
      return null;
    case "state":
      return { kind: "state", path: subject.path };
    case "outcome":
      return { kind: "outcome", path: subject.path, id: subject.id };
    case "port":
      return subject.port;
    case "connection":
      return subject.connection;
  }
}

/** The states around it, each a way there. */
function Way({ seen, isOfState }: { seen: SeenState; isOfState: boolean }) {
  const { path, state, machine } = seen;
  const around = lineage(path).slice(0, isOfState ? -1 : undefined);
  return (
    <nav className="inspector-way" aria-label="States around it">
      {around.map((each) => (
        <button
          key={each}
          type="button"
          className="inspector-link"
          onClick={() => seen.show({ kind: "state", path: each })}
        >
          {machine.state(each)?.name ?? each}
        </button>
      ))}
      {isOfState && <span className="inspector-faint">{KIND_WORDS[state.kind]}</span>}
    </nav>
  );
}

/** Content of a library is only looked at; the library itself is near. */
function InLibrary({ seen }: { seen: SeenState }) {
  const { path, machine, tab } = seen;
  const library = nearestLibrary(seen);
  if (library === null) return null;
  const open = () => {
    select(tab.view, [{ kind: "state", path: library }]);
    seen.run("file.open-library");
  };
  return (
    <div className="inspector-note" role="note">
      <p>
        This belongs to the library {machine.state(library)?.library?.name ?? path} and is the same
        wherever that is used: it is changed in the library itself.
      </p>
      <Button icon={<ExternalLink size={14} />} onClick={open}>
        Open library
      </Button>
    </div>
  );
}

/** The library state that the state is content of: the nearest one around it. */
function nearestLibrary({ path, machine }: SeenState): string | null {
  for (let outer = parentOf(path); outer !== null; outer = parentOf(outer))
    if (machine.state(outer)?.kind === "library") return outer;
  return null;
}
