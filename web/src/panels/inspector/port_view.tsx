/** Inspector of a port or scoped variable: its properties, its sources, and its targets, across all levels. */

import { textOfDefault } from "../../model/default_text.ts";
import { keyOf } from "../../model/element.ts";
import { chain, type DataPort } from "../../model/ends.ts";
import type { PortDocument } from "../../model/generated/protocol.ts";
import { portsOf } from "../../model/machine.ts";
import { shortType } from "../../model/types.ts";
import { setPortDefault, setPortType, setRuntimeValue } from "../../plan/ports.ts";
import { TextField } from "../../ui/field.tsx";
import { ChainTable } from "./chain_table.tsx";
import { Fold } from "./fold.tsx";
import type { InspectedState } from "./inspector_context.ts";
import { PORT_TITLES, read, typesIn } from "./ports.tsx";
import { useRenaming } from "./renaming.tsx";

export function PortView({ inspected, port: ref }: { inspected: InspectedState; port: DataPort }) {
  const { machine, state } = inspected;
  const port = portsOf(state, ref.kind).find(({ id }) => id === ref.id);
  if (!port) return null;
  return (
    <>
      <Fields key={keyOf(ref)} inspected={inspected} element={ref} port={port} />
      <ChainTable
        context={inspected}
        title="Fed by"
        hops={chain(machine, ref, "backwards")}
        none="Nothing feeds this port. It uses its default."
      />
      <ChainTable
        context={inspected}
        title="Feeds"
        hops={chain(machine, ref, "forwards")}
        none="This port feeds nothing."
      />
    </>
  );
}

interface FieldsProps {
  readonly inspected: InspectedState;
  readonly element: DataPort;
  readonly port: PortDocument;
}

function Fields({ inspected, element, port }: FieldsProps) {
  const { state, machine, readOnly, edit } = inspected;
  const [rename, asking] = useRenaming(inspected);
  const isLibrary = state.library != null;
  const canChange = !readOnly && !isLibrary;
  const list = element.kind === "input" ? state.library?.inputs : state.library?.outputs;
  const here = list?.find((each) => each.port === port.id);
  return (
    <Fold title={PORT_TITLES[element.kind].single}>
      <div className="inspector-fields">
        <TextField
          label="Name"
          value={port.name}
          readOnly={!canChange}
          onCommit={(text) => rename(element, text)}
        />
        <TextField
          label="Type"
          mono
          value={shortType(port.data_type)}
          readOnly={!canChange}
          suggestions={typesIn(machine)}
          onCommit={(text) => edit((now) => setPortType(now, element, text))}
        />
        <TextField
          label={isLibrary ? "Default in the library" : PORT_TITLES[element.kind].value}
          mono
          value={textOfDefault(port.default)}
          readOnly={!canChange}
          onCommit={(text) =>
            edit((now) => read(text, port, (value) => setPortDefault(now, element, value)))
          }
        />
        {isLibrary && (
          <TextField
            label={here?.used ? "Value used here" : "Value here, not used"}
            mono
            value={textOfDefault(here?.value ?? port.default)}
            readOnly={readOnly}
            onCommit={(text) =>
              edit((now) => read(text, port, (value) => setRuntimeValue(now, element, value)))
            }
          />
        )}
        <TextField label="Id" mono readOnly value={String(port.id)} />
      </div>
      {asking}
    </Fold>
  );
}
