/** Inspector: all properties of the selection in one column. A pinned inspector keeps its elements. */

import { ExternalLink, LocateFixed, Pin, PinOff } from "lucide-react";
import { memo, useDeferredValue, useMemo, useState } from "react";
import { type ElementKey, type ElementRef, elementOf } from "../../model/element.ts";
import { nameOf } from "../../model/ends.ts";
import { lineage, parentOf } from "../../model/path.ts";
import { KIND_WORDS } from "../../plan/legal.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { select } from "../../store/page/view.ts";
import { Button, IconButton } from "../../ui/button.tsx";
import { Empty } from "../../ui/empty.tsx";
import { useSignal } from "../../ui/signals.ts";
import { useActiveTab, useCommand, useHost } from "../context.tsx";
import { ConnectionView } from "./connection_view.tsx";
import {
  type InspectedState,
  type InspectorContext,
  inspectedState,
  makeEdit,
} from "./inspector_context.ts";
import { counted, ELEMENT_ICONS, KIND_ICONS } from "./kinds.ts";
import { MachineView } from "./machine_view.tsx";
import { OutcomeView } from "./outcome_view.tsx";
import { PortView } from "./port_view.tsx";
import { SeveralView } from "./several_view.tsx";
import { StateView } from "./state_view.tsx";
import { pathOf, type Subject, subjectOf } from "./subject.ts";
import "./inspector.css";

/** Elements that the inspector is pinned to. */
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
        text="Open a machine and select an element to view and edit it here."
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

/** Defers the update of the inspector, so that the canvas shows selections and edits at once. */
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
  /** Version of the machine, which is a mutable object. A new version renders the component again. */
  readonly version: number;
}

const Shown = memo(function Shown({ tab, pinned, onPin, elements }: ShownProps) {
  const context = useInspectorContext(tab);
  const subject = subjectOf(context.machine, elements);
  const state = inspectedState(context, pathOf(context.machine, subject));
  if (!state) return null;
  const pin = () => onPin(pinned ? null : { tab, elements });
  return (
    <div className="inspector">
      <Head inspected={state} subject={subject} isPinned={pinned !== null} onPin={pin} />
      <div className="inspector-column">
        {context.machine.isInLibrary(state.path) && <InLibrary inspected={state} />}
        <View inspected={state} subject={subject} isSelected={pinned === null} />
      </div>
    </div>
  );
});

function elementsOf(selection: ReadonlySet<ElementKey>): readonly ElementRef[] {
  return [...selection].flatMap((key) => elementOf(key) ?? []);
}

/** Current machine, with functions that act on it. */
function useInspectorContext(tab: OpenTab): InspectorContext {
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
  readonly inspected: InspectedState;
  readonly subject: Subject;
  readonly isSelected: boolean;
}

function View({ inspected, subject, isSelected }: ViewProps) {
  switch (subject.kind) {
    case "machine":
      return <MachineView inspected={inspected} />;
    case "state":
      return <StateView inspected={inspected} />;
    case "port":
      return <PortView inspected={inspected} port={subject.port} />;
    case "outcome":
      return <OutcomeView inspected={inspected} id={subject.id} />;
    case "connection":
      return <ConnectionView inspected={inspected} connection={subject.connection} />;
    case "several":
      return (
        <SeveralView context={inspected} elements={subject.elements} isSelected={isSelected} />
      );
  }
}

interface HeadProps {
  readonly inspected: InspectedState;
  readonly subject: Subject;
  readonly isPinned: boolean;
  readonly onPin: () => void;
}

function Head({ inspected, subject, isPinned, onPin }: HeadProps) {
  const { state } = inspected;
  const element = elementIn(subject);
  const kind = element?.kind ?? "state";
  const Icon = kind === "state" || kind === "income" ? KIND_ICONS[state.kind] : ELEMENT_ICONS[kind];
  return (
    <div className="inspector-head">
      <div className="inspector-title">
        <Icon size={16} aria-hidden />
        <h2 title={titleOf(inspected, subject)}>{titleOf(inspected, subject)}</h2>
        {element && (
          <IconButton
            label="Show on the canvas"
            icon={<LocateFixed size={15} />}
            onClick={() => inspected.show(element)}
          />
        )}
        <IconButton
          label={isPinned ? "Follow the selection again" : "Pin this selection"}
          icon={isPinned ? <PinOff size={15} /> : <Pin size={15} />}
          pressed={isPinned}
          onClick={onPin}
        />
      </div>
      {subject.kind !== "machine" && (
        <Way inspected={inspected} isOfState={subject.kind === "state"} />
      )}
    </div>
  );
}

function titleOf({ machine, state }: InspectedState, subject: Subject): string {
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

/** Links to the states around the element. */
function Way({ inspected, isOfState }: { inspected: InspectedState; isOfState: boolean }) {
  const { path, state, machine } = inspected;
  const around = lineage(path).slice(0, isOfState ? -1 : undefined);
  return (
    <nav className="inspector-way" aria-label="Enclosing states">
      {around.map((each) => (
        <button
          key={each}
          type="button"
          className="inspector-link"
          onClick={() => inspected.show({ kind: "state", path: each })}
        >
          {machine.state(each)?.name ?? each}
        </button>
      ))}
      {isOfState && <span className="inspector-faint">{KIND_WORDS[state.kind]}</span>}
    </nav>
  );
}

/** Hint that content of a library is read-only, with a link to the library state. */
function InLibrary({ inspected }: { inspected: InspectedState }) {
  const { path, machine, tab } = inspected;
  const library = nearestLibrary(inspected);
  if (library === null) return null;
  const open = () => {
    select(tab.view, [{ kind: "state", path: library }]);
    inspected.run("file.open-library");
  };
  return (
    <div className="inspector-note" role="note">
      <p>
        This belongs to the library {machine.state(library)?.library?.name ?? path} and is the same
        wherever the library is used. Edit it in the library itself.
      </p>
      <Button icon={<ExternalLink size={14} />} onClick={open}>
        Open library
      </Button>
    </div>
  );
}

/** Library state with this content: the nearest one around it. */
function nearestLibrary({ path, machine }: InspectedState): string | null {
  for (let outer = parentOf(path); outer !== null; outer = parentOf(outer))
    if (machine.state(outer)?.kind === "library") return outer;
  return null;
}
