/** Inspector of a transition or data flow: both ends, and its waypoints. */

import { Trash2 } from "lucide-react";
import { type ConnectionRef, chain, endsOf, isPort } from "../../model/ends.ts";
import { waypointsOf } from "../../model/layout_reader.ts";
import { namesTo } from "../../model/machine.ts";
import { type ConnectionEnd, reconnect } from "../../plan/connect.ts";
import { setWaypoints } from "../../plan/move.ts";
import { removeElements } from "../../plan/states.ts";
import { Button } from "../../ui/button.tsx";
import { ChainTable } from "./chain_table.tsx";
import { EndSelect } from "./end_select.tsx";
import { Fold } from "./fold.tsx";
import type { InspectedState } from "./inspector_context.ts";
import { Refusal, useRefusal } from "./refusal.tsx";

interface ConnectionViewProps {
  readonly inspected: InspectedState;
  readonly connection: ConnectionRef;
}

export function ConnectionView({ inspected, connection }: ConnectionViewProps) {
  const { machine, state, readOnly, edit } = inspected;
  const [refusal, run] = useRefusal();
  const { kind, path, id } = connection;
  const element = { kind, path, id };
  const ends = endsOf(machine, element);
  const points = waypointsOf(state, kind, id).length;
  const end = (which: ConnectionEnd, label: string) => (
    <EndSelect
      machine={machine}
      container={path}
      kind={kind}
      end={which}
      label={label}
      value={ends?.[which] ?? null}
      other={ends?.[which === "from" ? "to" : "from"] ?? null}
      disabled={readOnly}
      onChange={(target) => {
        if (target) run(edit((now) => reconnect(now, element, which, target)));
      }}
    />
  );
  return (
    <>
      <Fold title={kind === "transition" ? "Transition" : "Data flow"}>
        <div className="inspector-fields">
          {end("from", "From")}
          {end("to", "To")}
          <p className="inspector-faint">
            In {namesTo(machine, path).join(" / ")}, id {id},{" "}
            {points === 0 ? "no waypoints" : points === 1 ? "1 waypoint" : `${points} waypoints`}
          </p>
        </div>
        {!readOnly && (
          <div className="inspector-bar">
            <Button
              disabled={points === 0}
              onClick={() => run(edit((now) => setWaypoints(now, element, [])))}
            >
              Remove waypoints
            </Button>
            <Button
              icon={<Trash2 size={14} />}
              onClick={() => run(edit((now) => removeElements(now, [element])))}
            >
              Remove
            </Button>
          </div>
        )}
        <Refusal text={refusal} />
      </Fold>
      {ends && isPort(ends.from) && isPort(ends.to) && (
        <>
          <ChainTable
            context={inspected}
            title="The value comes from"
            hops={[
              { port: ends.from, steps: 0, flow: null },
              ...chain(machine, ends.from, "backwards"),
            ]}
          />
          <ChainTable
            context={inspected}
            title="The value goes to"
            hops={[{ port: ends.to, steps: 0, flow: null }, ...chain(machine, ends.to, "forwards")]}
          />
        </>
      )}
    </>
  );
}
