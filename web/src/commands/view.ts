/** Commands of the View menu: camera, layers and panels. None changes a machine. */

import { readLayout } from "../model/layout_reader.ts";
import type { Page, Settings } from "../store/page/page.ts";
import { THEMES } from "../store/page/settings.ts";
import { TIME_SCALES } from "../store/page/times.ts";
import type { FlowMode, HeatMode, ViewModes } from "../store/page/view.ts";
import { selected, selectedStates } from "../store/page/view.ts";
import type { CommandChoice, CommandContext, PanelSide, UserCommand } from "./command.ts";
import { anyOnlyState } from "./subject.ts";

const isOpen = (context: CommandContext) => context.tab !== null;
const hasSelection = ({ tab }: CommandContext) => (tab?.view.selection.value.size ?? 0) > 0;

const ZOOM_STEP = 1.4;

const LOOK: readonly UserCommand[] = [
  {
    id: "view.fit",
    title: "Fit all",
    keys: ["F"],
    classic: ["Ctrl+Space"],
    menu: "View/1",
    enabled: isOpen,
    run: ({ canvas }) => canvas?.fit([]),
  },
  {
    id: "view.zoom-selection",
    title: "Zoom to selection",
    keys: ["Z"],
    menu: "View/1",
    needs: "select something first",
    enabled: hasSelection,
    run: ({ canvas, tab }) => {
      if (!tab) return;
      const states = selectedStates(tab.view);
      const [first] = selected(tab.view);
      if (states.length > 0) canvas?.fit(states);
      else if (first) canvas?.reveal(first);
    },
  },
  {
    id: "view.zoom-in",
    title: "Zoom in",
    keys: ["Ctrl+Plus", "Ctrl+=", "Plus"],
    menu: "View/1",
    enabled: isOpen,
    run: ({ canvas }) => canvas?.zoom(ZOOM_STEP),
  },
  {
    id: "view.zoom-out",
    title: "Zoom out",
    keys: ["Ctrl+-", "-"],
    menu: "View/1",
    enabled: isOpen,
    run: ({ canvas }) => canvas?.zoom(1 / ZOOM_STEP),
  },
];

type Switch = { [K in keyof ViewModes]: ViewModes[K] extends boolean ? K : never }[keyof ViewModes];

function mode(
  name: Switch,
  id: "transitions" | "names" | "values" | "aborted" | "grid",
  title: string,
  keys: readonly string[],
  classic?: readonly string[],
): UserCommand {
  return {
    id: `view.${id}`,
    title,
    keys,
    ...(classic ? { classic } : {}),
    menu: "View/2",
    enabled: isOpen,
    checked: ({ tab }) => tab?.view.modes.value[name] ?? false,
    run: ({ tab }: CommandContext) => {
      if (!tab) return;
      const before = tab.view.modes.peek();
      tab.view.modes.value = { ...before, [name]: !before[name] };
    },
  };
}

const FLOWS: readonly { value: FlowMode; title: string }[] = [
  { value: "selection", title: "Selection only" },
  { value: "all", title: "All" },
  { value: "none", title: "None" },
];

const HEATS: readonly { value: HeatMode; title: string }[] = [
  { value: "off", title: "None" },
  { value: "count", title: "Executions per state" },
  { value: "time", title: "Total time per state" },
];

const MODES: readonly UserCommand[] = [
  mode("transitions", "transitions", "Transitions", ["T"], ["Ctrl+T", "T"]),
  {
    id: "view.data-flows",
    title: "Data flows",
    detail: "Cycles through data flows of the selection, all, and none.",
    keys: ["D"],
    classic: ["Ctrl+D"],
    menu: "View/2",
    enabled: isOpen,
    choices: ({ tab }) =>
      FLOWS.map(({ value, title }) => ({
        title,
        argument: value,
        checked: tab?.view.modes.value.dataFlows === value,
      })),
    run: ({ tab }, argument) => {
      if (!tab) return;
      const before = tab.view.modes.peek();
      const at = FLOWS.findIndex(({ value }) => value === before.dataFlows);
      const next = FLOWS[(at + 1) % FLOWS.length]?.value ?? "selection";
      const dataFlows = argument ?? next;
      tab.view.modes.value = { ...before, dataFlows };
    },
  },
  {
    id: "view.heat",
    title: "Heat",
    detail: "Cycles through colours by number of runs, by time, and none.",
    keys: ["Shift+H"],
    menu: "View/2",
    needs: "start a run first, or choose one",
    enabled: ({ tab }) => tab?.run.value != null,
    checked: ({ tab }) => tab !== null && tab.view.heat.value !== "off",
    choices: ({ tab }) =>
      HEATS.map(({ value, title }) => ({
        title,
        argument: value,
        checked: tab?.view.heat.value === value,
      })),
    run: ({ tab }, argument) => {
      if (!tab) return;
      const at = HEATS.findIndex(({ value }) => value === tab.view.heat.peek());
      const next = HEATS[(at + 1) % HEATS.length]?.value ?? "off";
      tab.view.heat.value = argument ?? next;
    },
  },
  mode("portNames", "names", "Port names", ["N"]),
  mode("values", "values", "Values", ["V"], ["Ctrl+L", "V"]),
  mode("aborted", "aborted", "Aborted and preempted", ["A"], ["Ctrl+P"]),
  mode("grid", "grid", "Grid", ["Shift+G"]),
  {
    id: "view.library-content",
    title: "Library content",
    detail: "Shows the content of the selected library state in place.",
    keys: ["Shift+L"],
    menu: "View/2",
    needs: "select a library state first",
    enabled: (context) => anyOnlyState(context)?.state.kind === "library",
    checked: isContentShown,
    run: async (context) => {
      const { tab } = context;
      const library = anyOnlyState(context);
      if (!tab || !library) return;
      const shown = !isContentShown(context);
      tab.view.contents.value = new Map(tab.view.contents.peek()).set(library.path, shown);
      if (shown) await tab.session.loadLibrary(library.path);
    },
  },
];

function isContentShown(context: CommandContext): boolean {
  const library = anyOnlyState(context);
  if (!library || !context.tab) return false;
  return (
    context.tab.view.contents.value.get(library.path) ?? readLayout(library.state).showsContent
  );
}

function side(which: PanelSide, title: string, keys: readonly string[]): UserCommand {
  return {
    id: `view.${which}`,
    title,
    keys,
    menu: "View/3",
    checked: ({ shell }) => shell.layouts.isShown(which),
    run: ({ shell }: CommandContext) => shell.layouts.toggle(which),
  };
}

const PANELS: readonly UserCommand[] = [
  {
    id: "view.panel",
    title: "Panel",
    menu: "View/3",
    choices: ({ shell }) =>
      shell.layouts.panels().map(({ id, title }) => ({ title, argument: id })),
    run: ({ shell }, argument) => (argument ? shell.showPanel(argument) : undefined),
  },
  side("left", "Left side", ["Ctrl+Alt+1"]),
  side("bottom", "Bottom side", ["Ctrl+Alt+2"]),
  side("right", "Right side", ["Ctrl+Alt+3"]),
  {
    id: "view.focus",
    title: "Canvas only",
    detail: "Hides or shows all panels.",
    keys: ["Ctrl+Alt+0"],
    menu: "View/3",
    run: ({ shell }) => shell.layouts.toggleFocus(),
  },
  {
    id: "view.layout",
    title: "Layout",
    menu: "View/4",
    choices: ({ shell }) => shell.layouts.names().map((name) => ({ title: name, argument: name })),
    run: ({ shell }, argument) => (argument ? shell.layouts.apply(argument) : undefined),
  },
  {
    id: "view.save-layout",
    title: "Save layout…",
    menu: "View/4",
    run: async ({ shell }) => {
      const name = await shell.prompt({
        title: "Save layout",
        label: "Name",
        check: (text) => (text.trim() === "" ? "A layout needs a name." : null),
      });
      if (name) shell.layouts.save(name.trim());
    },
  },
  {
    id: "view.remove-layout",
    title: "Remove layout",
    menu: "View/4",
    enabled: ({ shell }) => shell.layouts.own().length > 0,
    choices: ({ shell }) => shell.layouts.own().map((name) => ({ title: name, argument: name })),
    run: ({ shell }, argument) => (argument ? shell.layouts.remove(argument) : undefined),
  },
  {
    id: "view.full-screen",
    title: "Full screen",
    keys: ["F11"],
    menu: "View/5",
    checked: () => globalThis.document?.fullscreenElement != null,
    run: () =>
      document.fullscreenElement
        ? document.exitFullscreen()
        : document.documentElement.requestFullscreen(),
  },
  {
    id: "view.theme",
    title: "Theme",
    menu: "View/5",
    choices: ({ page }) => settingChoices(page, "theme", THEMES),
    run: ({ page }, argument) => set(page, "theme", argument),
  },
  {
    id: "view.times",
    title: "Times",
    menu: "View/5",
    choices: ({ page }) => settingChoices(page, "times", TIME_SCALES),
    run: ({ page }, argument) => set(page, "times", argument),
  },
];

/** Values of a setting. */
function settingChoices<K extends keyof Settings>(
  { settings }: Page,
  key: K,
  values: readonly { readonly value: Settings[K]; readonly title: string }[],
): readonly CommandChoice<Settings[K]>[] {
  return values.map(({ value, title }) => ({
    title,
    argument: value,
    checked: settings.value[key] === value,
  }));
}

function set<K extends keyof Settings>({ settings }: Page, key: K, value?: Settings[K]): void {
  if (value !== undefined) settings.value = { ...settings.peek(), [key]: value };
}

export const VIEW: readonly UserCommand[] = [...LOOK, ...MODES, ...PANELS];
