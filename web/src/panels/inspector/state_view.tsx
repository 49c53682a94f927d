/** A state in the inspector: everything about it in one column. */

import { isContainer } from "../../model/machine.ts";
import { Connections } from "./connections.tsx";
import { Description } from "./description.tsx";
import { General } from "./general.tsx";
import { InRun } from "./in_run.tsx";
import { Outcomes } from "./outcomes.tsx";
import { Place } from "./place.tsx";
import { Ports } from "./ports.tsx";
import { Script } from "./script.tsx";
import type { SeenState } from "./seen.ts";
import { Semantic } from "./semantic.tsx";

export function StateView({ seen }: { seen: SeenState }) {
  const { path, state } = seen;
  const hasScript = state.kind === "execution" || state.kind === "decider";
  return (
    <>
      <InRun seen={seen} />
      <General seen={seen} />
      <Description key={`description ${path}`} seen={seen} />
      {hasScript && <Script key={`script ${path}`} seen={seen} />}
      <Ports key={`inputs ${path}`} seen={seen} kind="input" />
      <Ports key={`outputs ${path}`} seen={seen} kind="output" />
      {isContainer(state) && <Ports key={`scoped ${path}`} seen={seen} kind="scoped_variable" />}
      <Outcomes key={`outcomes ${path}`} seen={seen} />
      <Connections key={`transitions ${path}`} seen={seen} kind="transition" />
      <Connections key={`flows ${path}`} seen={seen} kind="data_flow" />
      <Semantic key={`semantic ${path}`} seen={seen} />
      <Place key={`place ${path}`} seen={seen} />
    </>
  );
}
