/** The upper edge: menus, search, how the connection is, who works here; below it the machines that are open. */

import { PanelBottom, PanelLeft, PanelRight, Search } from "lucide-react";
import { IconButton } from "../ui/button.tsx";
import { isSameList, useComputed, useSignal } from "../ui/signals.ts";
import { AttentionButtons } from "./attention_buttons.tsx";
import { useShownKey } from "./keys_shown.ts";
import { LinkState } from "./link_state.tsx";
import { MachineTabs } from "./machine_tabs.tsx";
import { MenuBar } from "./menu_bar.tsx";
import { NoticeBell } from "./notice_centre.tsx";
import { People } from "./people.tsx";
import { RunControls } from "./run_controls.tsx";
import { useSession } from "./session_context.tsx";
import "./top_bar.css";

export function TopBar() {
  const { commands, context } = useSession();
  const shown = useShownKey();
  return (
    <header className="top">
      <div className="top-row">
        <span className="top-name">RAFCON</span>
        <MenuBar />
        <button
          type="button"
          className="top-search"
          onClick={() => commands.run("help.palette", context())}
        >
          <Search size={14} aria-hidden />
          <span>Search states, machines, commands</span>
          <kbd>{shown("help.palette")}</kbd>
        </button>
        <div className="top-end">
          <AttentionButtons />
          <NoticeBell />
          <Sides />
          <LinkState />
        </div>
      </div>
      <div className="top-row top-machines">
        <MachineTabs />
        <RunControls />
        <People />
      </div>
    </header>
  );
}

const SIDES = [
  ["left", PanelLeft],
  ["bottom", PanelBottom],
  ["right", PanelRight],
] as const;

function Sides() {
  const { commands, context, dock } = useSession();
  const shown = useShownKey();
  const { layouts } = useSignal(dock);
  const isShown = useComputed(
    () => SIDES.map(([side]) => layouts.isShown(side)),
    [layouts],
    isSameList,
  );
  return (
    <div className="tool-group" role="toolbar" aria-label="Panel sides">
      {SIDES.map(([side, Icon], index) => (
        <IconButton
          key={side}
          label={commands.get(`view.${side}`)?.title ?? side}
          icon={<Icon size={16} />}
          keys={shown(`view.${side}`)}
          pressed={isShown[index] === true}
          onClick={() => commands.run(`view.${side}`, context())}
        />
      ))}
    </div>
  );
}
