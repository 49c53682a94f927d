/** Placeholder of panels that need a run: the missing content, and a button to start a run. */

import { Play } from "lucide-react";
import { Empty } from "../../ui/empty.tsx";
import { useCommand } from "../context.tsx";

export function NoRun({ what }: { readonly what: string }) {
  const run = useCommand();
  return (
    <Empty
      icon={<Play size={22} />}
      title="No run is shown"
      text={`Start the machine, or choose one of its runs. ${what}`}
      action={{ title: "Start", onClick: () => run("run.start") }}
    />
  );
}
