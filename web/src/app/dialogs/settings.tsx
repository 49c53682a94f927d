/** Settings of this browser. */

import type { Settings } from "../../store/page/page.ts";
import { THEMES } from "../../store/page/settings.ts";
import { TIME_SCALES } from "../../store/page/times.ts";
import { Button } from "../../ui/button.tsx";
import { Dialog } from "../../ui/dialog.tsx";
import { Select } from "../../ui/field.tsx";
import { useSignal } from "../../ui/signals.ts";
import { useSession } from "../session_context.tsx";
import type { NamedDialogProps } from "./dialogs.tsx";

export function SettingsDialog({ answer }: NamedDialogProps<"settings">) {
  const { page, commands, context } = useSession();
  const settings = useSignal(page.settings);
  const change = (part: Partial<Settings>) => {
    page.settings.value = { ...page.settings.peek(), ...part };
  };
  return (
    <Dialog title="Settings" onClose={() => answer(null)}>
      <div className="form">
        <Select
          label="Theme"
          value={settings.theme}
          options={THEMES}
          onChange={(theme) => change({ theme })}
        />
        <Select
          label="Mouse wheel"
          value={settings.wheel}
          options={[
            { value: "zoom", title: "Zooms; with Shift, moves sideways" },
            { value: "pan", title: "Moves; with Ctrl, zooms" },
          ]}
          onChange={(wheel) => change({ wheel })}
        />
        <Select
          label="Times"
          value={settings.times}
          options={TIME_SCALES}
          onChange={(times) => change({ times })}
        />
        <div className="form-row">
          <Select
            label="Keys"
            value={settings.keymap}
            options={[
              { value: "rafcon", title: "RAFCON" },
              { value: "classic", title: "RAFCON classic" },
            ]}
            onChange={(keymap) => change({ keymap })}
          />
          <Button
            onClick={() => {
              answer(null);
              commands.run("help.keys", context());
            }}
          >
            Change keys…
          </Button>
        </div>
      </div>
    </Dialog>
  );
}
