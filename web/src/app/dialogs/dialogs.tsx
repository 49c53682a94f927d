/** The dialogs that are open, one upon the other. */

import type { FunctionComponent } from "react";
import { useSignal } from "../../ui/signals.ts";
import { useSession } from "../provided.tsx";
import type { OpenDialog } from "../session.ts";
import { About } from "./about.tsx";
import { Ask } from "./ask.tsx";
import { BreakpointDialog } from "./breakpoint.tsx";
import { Colour } from "./colour.tsx";
import { Keys } from "./keys.tsx";
import { LibraryChooser } from "./library_chooser.tsx";
import { NewMachine } from "./new_machine.tsx";
import { OpenMachine } from "./open_machine.tsx";
import { SaveAs } from "./save_as.tsx";
import { SettingsDialog } from "./settings.tsx";
import { StartRunDialog } from "./start_run.tsx";
import { TakeUp } from "./take_up.tsx";
import "./dialogs.css";

/** What a dialog is given: what it is asked, and where its answer goes. Null closes it without one. */
export interface AskedDialogProps<Asks> {
  readonly asks: Asks;
  readonly answer: (answer: unknown) => void;
}

const DIALOGS: Readonly<Record<OpenDialog["name"], FunctionComponent<AskedDialogProps<never>>>> = {
  question: Ask,
  open: OpenMachine,
  "save-as": SaveAs,
  new: NewMachine,
  library: LibraryChooser,
  colour: Colour,
  "start-run": StartRunDialog,
  "take-up": TakeUp,
  breakpoint: BreakpointDialog,
  keys: Keys,
  settings: SettingsDialog,
  about: About,
};

export function OpenDialogs() {
  const { dialogs } = useSession();
  return useSignal(dialogs).map(({ id, name, asks, answer }) => {
    const Component = DIALOGS[name];
    return <Component key={id} asks={asks as never} answer={answer} />;
  });
}
