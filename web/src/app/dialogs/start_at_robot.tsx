/** Which machine of a robot is to be started. */

import { Workflow } from "lucide-react";
import { useEffect, useState } from "react";
import { pathOf } from "../../commands/run_again.ts";
import type { MachineFile, RobotMachines } from "../../model/generated/protocol.ts";
import { clock1s } from "../../store/page/clock1s.ts";
import { LatestRequest } from "../../store/page/latest_request.ts";
import { utcTime } from "../../store/page/times.ts";
import { Button } from "../../ui/button.tsx";
import { Dialog } from "../../ui/dialog.tsx";
import { Empty } from "../../ui/empty.tsx";
import { Select, TextField } from "../../ui/field.tsx";
import { useSignal } from "../../ui/signals.ts";
import { Tree } from "../../ui/tree.tsx";
import { useSession } from "../session_context.tsx";
import type { NamedDialogProps } from "./dialogs.tsx";
import { keysAboveTree } from "./tree_below.ts";

const noChildren = () => null;

export function StartAtRobot({ answer }: NamedDialogProps<"start-at-robot">) {
  const { page } = useSession();
  const robots = useSignal(page.robots);
  const [robot, setRobot] = useState(robots[0] ?? "");
  const [search, setSearch] = useState("");
  const [chosen, setChosen] = useState<MachineFile | null>(null);
  const { list, fault } = useMachines(robot);
  const words = search.trim().toLowerCase();
  const found = list?.machines.filter((file) => pathOf(file).toLowerCase().includes(words)) ?? [];
  const wanted = chosen ?? (words === "" ? null : (found[0] ?? null));
  const take = (machine: MachineFile | null) => {
    if (machine !== null) answer({ robot, machine });
  };
  return (
    <Dialog
      title="Start a machine of a robot"
      width={560}
      height={560}
      onClose={() => answer(null)}
      footer={
        <>
          <Button onClick={() => answer(null)}>Cancel</Button>
          <Button kind="primary" disabled={wanted === null} onClick={() => take(wanted)}>
            {robot === "" ? "Start" : `Start on ${robot}`}
          </Button>
        </>
      }
    >
      <div className="form">
        {robots.length > 1 && (
          <Select
            label="Robot"
            value={robot}
            options={robots.map((value) => ({ value, title: value }))}
            onChange={(name) => {
              setRobot(name);
              setChosen(null);
            }}
          />
        )}
        <TextField
          label="Find a machine"
          hideLabel
          type="search"
          placeholder={robot === "" ? "Find a machine" : `Find a machine of ${robot}`}
          value={search}
          onInput={(text) => {
            setSearch(text);
            setChosen(null);
          }}
          autoFocus
          onKeyDown={(event) => keysAboveTree(event, () => take(wanted))}
        />
        <div className="form-tree">
          {list === null || found.length === 0 ? (
            <NoMachine robot={robot} list={list} fault={fault} search={search} />
          ) : (
            <Tree
              label={`Machines of ${robot}`}
              roots={found}
              id={pathOf}
              childrenOf={noChildren}
              text={pathOf}
              expanded={EMPTY}
              selected={new Set(wanted ? [pathOf(wanted)] : [])}
              reveal={wanted ? pathOf(wanted) : null}
              onExpand={() => {}}
              onSelect={setChosen}
              onOpen={take}
              row={(file) => (
                <>
                  <Workflow size={14} className="tree-icon tree-icon-machine" aria-hidden />
                  {pathOf(file)}
                </>
              )}
            />
          )}
        </div>
        {list !== null && <Age list={list} />}
      </div>
    </Dialog>
  );
}

const EMPTY: ReadonlySet<string> = new Set();

function Age({ list: { made_ms, more } }: { readonly list: RobotMachines }) {
  return (
    <p className="form-note">
      As the robot listed them at {utcTime(made_ms, clock1s.peek())} by its calendar.
      {more > 0 && ` ${more} that changed earlier are not listed.`}
    </p>
  );
}

function NoMachine(props: {
  readonly robot: string;
  readonly list: RobotMachines | null;
  readonly fault: string | null;
  readonly search: string;
}) {
  const { robot, list, fault, search } = props;
  if (fault !== null) return <Empty title="The machines are unknown" text={fault} />;
  if (list === null) return <Empty title="Loading…" text="" />;
  if (search.trim() === "") {
    return <Empty title="No machines" text={`No project of ${robot} has a machine.`} />;
  }
  return <Empty title="Nothing found" text={`No path of a machine contains “${search}”.`} />;
}

interface KnownMachines {
  readonly robot: string;
  readonly list: RobotMachines | null;
  /** Reason why the list is unknown. */
  readonly fault: string | null;
}

/** The list of a robot's machines that the station has; null before it is known. */
function useMachines(robot: string): Pick<KnownMachines, "list" | "fault"> {
  const { page } = useSession();
  const [known, setKnown] = useState<KnownMachines>({ robot, list: null, fault: null });
  useEffect(() => {
    const request = new LatestRequest<string, RobotMachines>({
      ask: (name) => page.server.request("GET", `/robots/${encodeURIComponent(name)}/machines`),
      take: (list, name) => setKnown({ robot: name, list, fault: null }),
      refused: ({ message }, name) => setKnown({ robot: name, list: null, fault: message }),
    });
    request.want(robot);
    return () => request.close();
  }, [page, robot]);
  return known.robot === robot ? known : { list: null, fault: null };
}
