/** The dialogs that are open, one upon the other. */

import type { FunctionComponent, ReactElement } from "react";
import { Dialog } from "../../ui/dialog.tsx";
import { type OnDemand, onDemand } from "../../ui/on_demand.tsx";
import { useSignal } from "../../ui/signals.ts";
import type { AllDialogs } from "../session.ts";
import { useSession } from "../session_context.tsx";
import { Ask } from "./ask.tsx";
import { ResumeCrashed } from "./resume_crashed.tsx";
import { StartRunDialog } from "./start_run.tsx";
import "./dialogs.css";

/** Properties of a dialog: its request, and the receiver of its result. Null closes it without a result. */
export interface AskedDialogProps<Asks, Answer = unknown> {
  readonly asks: Asks;
  readonly answer: (answer: Answer | null) => void;
}

/** Properties of the dialog of a name. */
export type NamedDialogProps<N extends keyof AllDialogs> = AskedDialogProps<
  AllDialogs[N]["asks"],
  AllDialogs[N]["answer"]
>;

const framed = (words: ReactElement, { answer }: { readonly answer: (answer: null) => void }) => (
  <Dialog title="Not loaded" onClose={() => answer(null)}>
    {words}
  </Dialog>
);

// Dialogs for commands of a run are loaded with the page, the others at their first use.
const About = onDemand(async () => (await import("./about.tsx")).About, framed);
const BreakpointDialog = onDemand(
  async () => (await import("./breakpoint.tsx")).BreakpointDialog,
  framed,
);
const Colour = onDemand(async () => (await import("./colour.tsx")).Colour, framed);
const Keys = onDemand(async () => (await import("./keys.tsx")).Keys, framed);
const LibraryChooser = onDemand(
  async () => (await import("./library_chooser.tsx")).LibraryChooser,
  framed,
);
const NewMachine = onDemand(async () => (await import("./new_machine.tsx")).NewMachine, framed);
const OpenMachine = onDemand(async () => (await import("./open_machine.tsx")).OpenMachine, framed);
const SaveAs = onDemand(async () => (await import("./save_as.tsx")).SaveAs, framed);
const SetAside = onDemand(async () => (await import("./set_aside.tsx")).SetAside, framed);
const SettingsDialog = onDemand(
  async () => (await import("./settings.tsx")).SettingsDialog,
  framed,
);

const StartAtRobot = onDemand(
  async () => (await import("./start_at_robot.tsx")).StartAtRobot,
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
export const DIALOGS: {
  readonly [N in keyof AllDialogs]: FunctionComponent<NamedDialogProps<N>>;
} = {
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
    // The opener has checked that request and name belong together.
    const Component = DIALOGS[name] as FunctionComponent<AskedDialogProps<unknown>>;
    return <Component key={id} asks={asks} answer={answer} />;
  });
  return (
    <>
      {open}
      {query !== null && <Palette initial={query} />}
    </>
  );
}
