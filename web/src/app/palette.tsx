/** The palette: everything by a few letters. */

import { Command as CommandSign, Library, Search, Workflow } from "lucide-react";
import { type KeyboardEvent, useEffect, useId, useMemo, useRef, useState } from "react";
import type { CommandChoice } from "../commands/command.ts";
import { refusalOf } from "../commands/command.ts";
import { shownKey } from "../commands/keys.ts";
import type { LibraryNode } from "../model/generated/protocol.ts";
import { type Machine, namesTo } from "../model/machine.ts";
import { stateIndex } from "../model/state_index.ts";
import { select } from "../store/page/view.ts";
import { useSignal } from "../ui/signals.ts";
import { useKeys } from "./keys_shown.ts";
import { KIND_ICONS } from "./kinds.ts";
import { type FindStates, type PaletteItem, searched } from "./palette_index.ts";
import { type ProjectNode, useProjects } from "./project_tree.tsx";
import type { AppSession } from "./session.ts";
import { useSession } from "./session_context.tsx";
import "./palette.css";

export function Palette({ initial }: { initial: string }) {
  const session = useSession();
  const place = useRef<HTMLDialogElement>(null);
  const before = useRef<Element | null>(document.activeElement);
  const [query, setQuery] = useState(initial);
  const [at, setAt] = useState(0);
  const id = useId();
  const items = useItems(session);
  const findStates = useFindStates(session);
  const found = useMemo(() => searched(items, query, findStates), [items, query, findStates]);
  useEffect(() => {
    place.current?.showModal();
  }, []);
  useEffect(() => {
    place.current?.querySelector("[aria-selected=true]")?.scrollIntoView({ block: "nearest" });
  });
  const close = () => {
    session.palette.value = null;
    if (before.current instanceof HTMLElement) before.current.focus();
  };
  const take = (item: PaletteItem | undefined) => {
    if (!item || item.disabled) return;
    close();
    goTo(session, item);
  };
  const key = (event: KeyboardEvent) => {
    event.stopPropagation();
    const steps: Record<string, number> = { ArrowDown: 1, ArrowUp: -1, PageDown: 10, PageUp: -10 };
    const by = steps[event.key];
    if (by !== undefined) setAt(Math.max(0, Math.min(found.length - 1, at + by)));
    else if (event.key === "Enter") take(found[at]);
    else return;
    event.preventDefault();
  };
  return (
    <dialog
      ref={place}
      className="palette"
      aria-label="Search everything"
      onCancel={(event) => {
        event.preventDefault();
        close();
      }}
      onClick={(event) => event.target === place.current && close()}
      onKeyDown={key}
    >
      <div className="palette-search">
        <Search size={16} aria-hidden />
        <input
          autoFocus
          role="combobox"
          aria-label="Search"
          aria-expanded
          aria-autocomplete="list"
          aria-controls={`${id}-list`}
          aria-activedescendant={found.length > 0 ? `${id}-${at}` : undefined}
          placeholder="States, machines, libraries, commands"
          spellCheck={false}
          autoComplete="off"
          value={query}
          onChange={(event) => {
            setQuery(event.currentTarget.value);
            setAt(0);
          }}
        />
      </div>
      <div
        id={`${id}-list`}
        className="palette-list"
        role="listbox"
        aria-label="Results"
        tabIndex={-1}
      >
        {found.map((item, index) => (
          <PaletteRow
            key={keyOf(item)}
            id={`${id}-${index}`}
            item={item}
            active={index === at}
            onTake={() => take(item)}
            onReach={() => setAt(index)}
          />
        ))}
        {found.length === 0 && <p className="palette-none">Nothing matches “{query}”.</p>}
      </div>
      <footer className="palette-foot">
        <span>
          <kbd>&gt;</kbd> commands
        </span>
        <span>
          <kbd>@</kbd> states
        </span>
        <span>
          <kbd>#</kbd> libraries
        </span>
      </footer>
    </dialog>
  );
}

interface PaletteRowProps {
  readonly id: string;
  readonly item: PaletteItem;
  readonly active: boolean;
  readonly onTake: () => void;
  readonly onReach: () => void;
}

function PaletteRow({ id, item, active, onTake, onReach }: PaletteRowProps) {
  return (
    // biome-ignore lint/a11y/useKeyWithClickEvents: the search field above has the keyboard
    <div
      id={id}
      role="option"
      tabIndex={-1}
      aria-selected={active}
      aria-disabled={item.disabled}
      className="palette-row"
      onClick={onTake}
      onMouseMove={onReach}
    >
      <Sign item={item} />
      <span className="palette-title">{item.title}</span>
      <span className="palette-detail">{item.detail}</span>
      {item.keys && <kbd>{item.keys}</kbd>}
    </div>
  );
}

function Sign({ item }: { item: PaletteItem }) {
  const { page } = useSession();
  const { found } = item;
  if (found.kind === "command") return <CommandSign size={14} aria-hidden />;
  if (found.kind === "library") return <Library size={14} aria-hidden />;
  if (found.kind === "machine") return <Workflow size={14} aria-hidden />;
  const kind = page.active.peek()?.session.machine.state(found.path)?.kind ?? "execution";
  const Icon = KIND_ICONS[kind];
  return <Icon size={14} aria-hidden />;
}

function keyOf({ found, title }: PaletteItem): string {
  switch (found.kind) {
    case "command":
      return `command:${found.command.id}:${title}`;
    case "library":
      return `library:${found.path}/${found.name}`;
    case "machine":
      return `machine:${found.project}/${found.path}`;
    case "state":
      return `state:${found.path}`;
  }
}

/** All that can be found now. */
function useItems(session: AppSession): readonly PaletteItem[] {
  const keys = useKeys();
  const projects = useProjects();
  const libraries = useSignal(session.page.libraries);
  // biome-ignore lint/correctness/useExhaustiveDependencies: while the palette is open, commands and states stay as they were
  return useMemo(
    () => [
      ...commandItems(session, keys),
      ...(projects ?? []).flatMap(machineItems),
      ...libraries.flatMap((root) => libraryItems(root.name, root.children)),
    ],
    [session, projects, libraries],
  );
}

function commandItems(
  { commands, context }: AppSession,
  keys: (id: string) => readonly string[],
): PaletteItem[] {
  const now = context();
  return commands.all().flatMap((command): PaletteItem[] => {
    if (command.id === "help.palette" || command.id === "help.commands") return [];
    const disabled = refusalOf(command, now) !== null;
    const [key] = keys(command.id);
    const menu = command.menu?.split("/")[0] ?? "";
    const item = (title: string, choice?: CommandChoice): PaletteItem => ({
      found: { kind: "command", command, ...(choice ? { choice } : {}) },
      title,
      detail: command.detail ?? menu,
      keys: key === undefined ? undefined : shownKey(key),
      disabled,
    });
    const choices = disabled ? undefined : command.choices?.(now);
    if (!choices) return [item(command.title)];
    return choices
      .filter((choice) => !choice.disabled)
      .map((choice) => item(`${command.title}: ${choice.title}`, choice));
  });
}

/** States of the current machine; the first ones without a search text. */
function useFindStates({ page }: AppSession): FindStates {
  return useMemo(() => {
    const machine = page.active.peek()?.session.machine;
    if (!machine) return () => [];
    const item = (path: string): PaletteItem => ({
      found: { kind: "state", path },
      title: machine.state(path)?.name ?? path,
      detail: namesTo(machine, path).slice(0, -1).reverse().join(" ‹ "),
    });
    return (text: string, count: number) => {
      if (text === "")
        return firstPaths(machine, count).map((path) => ({ item: item(path), score: 0 }));
      const found = stateIndex(machine).find(text, count);
      return found.map(({ path, score }) => ({ item: item(path), score }));
    };
  }, [page]);
}

function firstPaths(machine: Machine, count: number): readonly string[] {
  const found: string[] = [];
  for (const path of machine.paths()) {
    if (found.length === count) break;
    found.push(path);
  }
  return found;
}

function machineItems(node: ProjectNode): PaletteItem[] {
  if (node.kind !== "machine") return (node.children ?? []).flatMap(machineItems);
  const { project, path } = node.file;
  return [
    { found: { kind: "machine", project, path }, title: node.name, detail: `${project} / ${path}` },
  ];
}

function libraryItems(path: string, nodes: readonly LibraryNode[]): PaletteItem[] {
  return nodes.flatMap((node) =>
    node.kind === "library"
      ? [{ found: { kind: "library", path, name: node.name }, title: node.name, detail: path }]
      : libraryItems(`${path}/${node.name}`, node.children ?? []),
  );
}

/** Does what was found: runs the command, flies to the state, opens the machine, adds the library. */
function goTo(session: AppSession, { found }: PaletteItem): void {
  const { commands, context, page, canvas } = session;
  switch (found.kind) {
    case "command":
      commands.choose(found.command, context(), found.choice);
      return;
    case "machine":
      commands.run("file.open", context(), { project: found.project, path: found.path });
      return;
    case "library":
      commands.run("insert.library", context(), {
        path: found.path,
        name: found.name,
      });
      return;
    case "state": {
      const tab = page.active.peek();
      if (!tab) return;
      const element = { kind: "state", path: found.path } as const;
      select(tab.view, [element]);
      canvas.peek()?.reveal(element);
      canvas.peek()?.focus();
    }
  }
}
