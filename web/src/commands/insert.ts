/** Commands of the Insert menu: states, ports, outcomes, connections. */

import type { Document, StateDocument, StateKind } from "../model/generated/protocol.ts";
import type { Point } from "../model/geometry.ts";
import { isContainer, type Machine, type PortKind } from "../model/machine.ts";
import { connectFromSibling, connectToParent, connectToSibling } from "../plan/connect.ts";
import { addTemplate } from "../plan/group.ts";
import { insertState, middleOf } from "../plan/insert.ts";
import { type Planned, refused } from "../plan/plan.ts";
import { addOutcome, addPort } from "../plan/ports.ts";
import { addLibrary, addState } from "../plan/states.ts";
import type { InsertLibrary } from "../store/page/command_arguments.ts";
import type { CommandContext, CommandOf, UserCommand } from "./command.ts";
import { perform } from "./perform.ts";
import { canEdit, elements, kindOfOnly, machineOf, onlyState, placeForNew } from "./subject.ts";

const KINDS = [
  ["execution", "Execution state", ["E"], ["Ctrl+Alt+E", "E"]],
  ["hierarchy", "Hierarchy", ["H"], ["Ctrl+Alt+H", "Ctrl+Shift+A", "H"]],
  ["barrier", "Barrier concurrency", ["B"], ["Ctrl+Alt+B", "B"]],
  ["preemptive", "Preemptive concurrency", ["P"], ["Ctrl+Alt+C", "P"]],
] as const;

const canPlace = (context: CommandContext) => canEdit(context) && placeForNew(context) !== null;

const STATES = KINDS.map(
  ([kind, title, keys, classic]): UserCommand => ({
    id: `insert.${kind}`,
    title,
    detail: "Adds the state at the pointer, or to the selected container.",
    keys,
    classic,
    menu: "Insert/1",
    enabled: canPlace,
    run: (context: CommandContext) => addHere(context, kind),
  }),
);

function addHere(context: CommandContext, kind: Exclude<StateKind, "library" | "decider">) {
  const place = placeForNew(context);
  return place && perform(context, (m) => addState(m, place.path, kind, place.at));
}

const LIBRARIES: readonly UserCommand[] = [
  {
    id: "insert.library",
    title: "Library state…",
    keys: ["L"],
    menu: "Insert/1",
    enabled: canPlace,
    run: (context, argument) =>
      withLibrary(context, argument, (machine, place, library, states) => {
        const [root] = states;
        return root ? withRoot(machine, place, library, root) : null;
      }),
  },
  {
    id: "insert.template",
    title: "Copy of a library…",
    detail: "Inserts the library's content as states of this machine.",
    menu: "Insert/1",
    enabled: canPlace,
    run: (context, argument) =>
      withLibrary(context, argument, (machine, place, _, states) =>
        addTemplate(machine, place.path, states, place.at),
      ),
  },
];

type Place = { readonly path: string; readonly at?: Point };

function withRoot(
  machine: Machine,
  { path, at }: Place,
  { transition: id, ...library }: InsertLibrary,
  root: StateDocument,
): Planned {
  if (id === undefined || !at) return addLibrary(machine, path, library, root, at);
  return insertState(machine, { kind: "transition", path, id }, { library, root }, at);
}

async function withLibrary(
  context: CommandContext,
  given: InsertLibrary | undefined,
  plan: (
    machine: Machine,
    place: Place,
    library: InsertLibrary,
    states: readonly StateDocument[],
  ) => Planned | null,
): Promise<void> {
  const free = placeForNew(context);
  const place =
    given?.container === undefined
      ? free
      : { path: given.container, ...(given.at ? { at: given.at } : {}) };
  const library =
    given ?? (await context.shell.dialog("library", { title: "Add a library", yes: "Add" }));
  if (!library || !place) return;
  const { states, version } = await libraryMachine(context, library);
  await perform(context, (machine) => {
    const planned = plan(machine, place, { ...library, version }, states);
    return planned ?? { refused: `The library ${library.name} is empty.` };
  });
}

interface LibraryMachine {
  /** The root first. */
  readonly states: readonly StateDocument[];
  /** A library state keeps the version that it is made with. */
  readonly version: string | null;
}

export async function libraryMachine(
  { page }: CommandContext,
  { path, name }: { readonly path: string; readonly name: string },
): Promise<LibraryMachine> {
  const parts = [...path.split("/"), name].map(encodeURIComponent);
  const document = await page.server.request<Document>("GET", `/libraries/${parts.join("/")}`);
  return { states: document.states, version: document.header.version ?? null };
}

/** The state whose interface is meant: the selected one, or the one whose port is. */
function owner(context: CommandContext): string | null {
  const paths = new Set(elements(context).map(({ path }) => path));
  const [path] = paths;
  const state = path === undefined ? undefined : machineOf(context)?.state(path);
  return paths.size === 1 && path !== undefined && state?.kind !== "library" ? path : null;
}

const hasOwner = (context: CommandContext) => canEdit(context) && owner(context) !== null;

function port(
  kind: PortKind,
  title: string,
  keys: readonly string[],
  classic: readonly string[],
): UserCommand {
  return {
    id: kind === "scoped_variable" ? "insert.scoped-variable" : `insert.${kind}`,
    title,
    keys,
    classic,
    menu: "Insert/2",
    needs:
      kind === "scoped_variable"
        ? "select one hierarchy or concurrency first"
        : "select one state first",
    enabled: (context) => {
      const path = owner(context);
      const state = path === null ? undefined : machineOf(context)?.state(path);
      const fits = kind !== "scoped_variable" || (state !== undefined && isContainer(state));
      return hasOwner(context) && fits;
    },
    run: (context: CommandContext) => {
      const path = owner(context);
      return path === null ? undefined : perform(context, (m) => addPort(m, path, kind));
    },
  };
}

const PORTS: readonly UserCommand[] = [
  {
    id: "insert.outcome",
    title: "Outcome",
    keys: ["O"],
    classic: ["Ctrl+Alt+O", "O"],
    menu: "Insert/2",
    needs: "select one state first",
    enabled: hasOwner,
    run: (context) => {
      const path = owner(context);
      return path === null ? undefined : perform(context, (m) => addOutcome(m, path));
    },
  },
  port("input", "Input port", ["I"], ["Ctrl+Alt+N", "I"]),
  port("output", "Output port", ["Shift+O"], ["Ctrl+Alt+U", "Shift+O"]),
  port("scoped_variable", "Scoped variable", ["Shift+V"], ["Ctrl+Alt+V", "Shift+V"]),
];

function helper(
  id: "transition-from-sibling" | "transition-to-sibling" | "transition-to-parent",
  title: string,
  classic: string,
  plan: (machine: Machine, path: string) => Planned,
): UserCommand {
  return {
    id: `insert.${id}`,
    title,
    classic: [classic],
    menu: "Insert/3",
    enabled: (context) => canEdit(context) && onlyState(context) !== null,
    run: (context: CommandContext) => {
      const path = onlyState(context);
      return path === null ? undefined : perform(context, (m) => plan(m, path));
    },
  };
}

const CONNECTIONS: readonly UserCommand[] = [
  {
    id: "insert.connect",
    title: "Connect…",
    detail: "Starts a connection at the selected port or state. Tab cycles through the targets.",
    keys: ["C"],
    menu: "Insert/3",
    needs: "select one state, port or outcome first",
    enabled: (context) => canEdit(context) && elements(context).length === 1,
    run: ({ canvas }) => canvas?.beginConnection(),
  },
  helper(
    "transition-from-sibling",
    "Transition from the nearest state",
    "Ctrl+Shift+C",
    connectFromSibling,
  ),
  helper(
    "transition-to-sibling",
    "Transition to the nearest state",
    "Ctrl+Shift+V",
    connectToSibling,
  ),
  helper(
    "transition-to-parent",
    "Transition to the first outcome of the container",
    "Ctrl+Shift+B",
    connectToParent,
  ),
];

/** Choices for a state in a transition: a new state of a kind, or a library state. */
const INTO_TRANSITION: CommandOf<"insert.into-transition"> = {
  id: "insert.into-transition",
  title: "Insert into transition",
  detail: "Inserts the new state into the selected transition.",
  menu: "Insert/3",
  enabled: (context) => canEdit(context) && transitionOf(context) !== null,
  choices: () => [
    ...KINDS.map(([kind, title]) => ({ title, argument: kind })),
    { title: "Library state…", argument: "library" },
  ],
  run: async (context, argument) => {
    const line = transitionOf(context);
    const machine = machineOf(context);
    if (!line || !machine) return;
    const at = middleOf(machine, line);
    const kind = KINDS.find(([each]) => each === argument)?.[0];
    if (kind) return perform(context, (m) => insertState(m, line, { kind }, at));
    const wanted = { title: "Insert a library into the transition", yes: "Insert" };
    const library = await context.shell.dialog("library", wanted);
    if (!library) return;
    const { states, version } = await libraryMachine(context, library);
    const [root] = states;
    return perform(context, (m) =>
      root
        ? insertState(m, line, { library: { ...library, version }, root }, at)
        : refused(`${library.name} is empty.`),
    );
  },
};

/** The one selected transition; of a container whose states run one after the other. */
function transitionOf(context: CommandContext) {
  const [line, ...more] = elements(context);
  if (line?.kind !== "transition" || more.length > 0) return null;
  return machineOf(context)?.state(line.path)?.kind === "hierarchy" ? line : null;
}

/** The command for the kind of the selection: used by "Add" of the reference. */
const ADD: CommandOf<"insert.fitting"> = {
  id: "insert.fitting",
  title: "Add state or outcome",
  detail: "Adds a state to a container, an outcome to anything else.",
  classic: ["Ctrl+A"],
  enabled: hasOwner,
  run: (context) => {
    const kind = kindOfOnly(context);
    const path = owner(context);
    if (kind === "execution" || kind === "decider") {
      return path === null ? undefined : perform(context, (m) => addOutcome(m, path));
    }
    return addHere(context, "execution");
  },
};

export const INSERT: readonly UserCommand[] = [
  ...STATES,
  ...LIBRARIES,
  ...PORTS,
  ...CONNECTIONS,
  INTO_TRANSITION,
  ADD,
].map((command) => ({ ...command, edits: true, once: true }));
