/** The dialogs that are open, one upon the other. */

import type { FunctionComponent, ReactElement } from "react";
import { Dialog } from "../../ui/dialog.tsx";
import { type OnDemand, onDemand } from "../../ui/on_demand.tsx";
import { useSignal } from "../../ui/signals.ts";
import { useSession } from "../provided.tsx";
import type { OpenDialog } from "../session.ts";
import { Ask } from "./ask.tsx";
import { ResumeCrashed } from "./resume_crashed.tsx";
import { StartRunDialog } from "./start_run.tsx";
import "./dialogs.css";

/** Properties of a dialog: its request, and the receiver of its result. Null closes it without a result. */
export interface AskedDialogProps<Asks> {
  readonly asks: Asks;
  readonly answer: (answer: unknown) => void;
}

const framed = (words: ReactElement, { answer }: AskedDialogProps<never>) => (
  <Dialog title="Not loaded" onClose={() => answer(null)}>
    {words}
  </Dialog>
);

// Dialogs for commands of a run are loaded with the page, the others at their first use.
const About = onDemand(
  async () => (await import("./about.tsx")).About as FunctionComponent<AskedDialogProps<never>>,
  framed,
);
const BreakpointDialog = onDemand(
  async () =>
    (await import("./breakpoint.tsx")).BreakpointDialog as FunctionComponent<
      AskedDialogProps<never>
    >,
  framed,
);
const Colour = onDemand(
  async () => (await import("./colour.tsx")).Colour as FunctionComponent<AskedDialogProps<never>>,
  framed,
);
const Keys = onDemand(
  async () => (await import("./keys.tsx")).Keys as FunctionComponent<AskedDialogProps<never>>,
  framed,
);
const LibraryChooser = onDemand(
  async () =>
    (await import("./library_chooser.tsx")).LibraryChooser as FunctionComponent<
      AskedDialogProps<never>
    >,
  framed,
);
const NewMachine = onDemand(
  async () =>
    (await import("./new_machine.tsx")).NewMachine as FunctionComponent<AskedDialogProps<never>>,
  framed,
);
const OpenMachine = onDemand(
  async () =>
    (await import("./open_machine.tsx")).OpenMachine as FunctionComponent<AskedDialogProps<never>>,
  framed,
);
const SaveAs = onDemand(
  async () => (await import("./save_as.tsx")).SaveAs as FunctionComponent<AskedDialogProps<never>>,
  framed,
);
const SetAside = onDemand(
  async () =>
    (await import("./set_aside.tsx")).SetAside as FunctionComponent<AskedDialogProps<never>>,
  framed,
);
const SettingsDialog = onDemand(
  async () =>
    (await import("./settings.tsx")).SettingsDialog as FunctionComponent<AskedDialogProps<never>>,
  framed,
);

const StartAtRobot = onDemand(
  async () =>
    (await import("./start_at_robot.tsx")).StartAtRobot as FunctionComponent<
      AskedDialogProps<never>
    >,
  framed,
);

const Palette = onDemand(async () => (await import("../palette.tsx")).Palette);

/** The dialogs that are loaded when they are first asked, or once the page has nothing else to do. */
export const LATER_DIALOGS: readonly OnDemand<never>[] = [
  Palette,
  About,
  BreakpointDialog,
  Colour,
  Keys,
  LibraryChooser,
  NewMachine,
  OpenMachine,
  SaveAs,
  SetAside,
  SettingsDialog,
  StartAtRobot,
];

/** All dialogs by name. */
export const DIALOGS: Readonly<
  Record<OpenDialog["name"], FunctionComponent<AskedDialogProps<never>>>
> = {
  question: Ask,
  open: OpenMachine,
  "save-as": SaveAs,
  new: NewMachine,
  library: LibraryChooser,
  colour: Colour,
  "start-run": StartRunDialog,
  "start-at-robot": StartAtRobot,
  "resume-crashed": ResumeCrashed,
  "set-aside": SetAside,
  breakpoint: BreakpointDialog,
  keys: Keys,
  settings: SettingsDialog,
  about: About,
};

export function OpenDialogs() {
  const { dialogs, palette } = useSession();
  const query = useSignal(palette);
  const open = useSignal(dialogs).map(({ id, name, asks, answer }) => {
    const Component = DIALOGS[name];
    return <Component key={id} asks={asks as never} answer={answer} />;
  });
  return (
    <>
      {open}
      {query !== null && <Palette initial={query} />}
    </>
  );
}
