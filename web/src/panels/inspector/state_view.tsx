/** Inspector of a state: all its properties in one column. */

import { isContainer } from "../../model/machine.ts";
import { Connections } from "./connections.tsx";
import { Description } from "./description.tsx";
import { General } from "./general.tsx";
import { InRun } from "./in_run.tsx";
import type { InspectedState } from "./inspector_context.ts";
import { LostLink } from "./lost_link.tsx";
import { Outcomes } from "./outcomes.tsx";
import { Place } from "./place.tsx";
import { Ports } from "./ports.tsx";
import { Script } from "./script.tsx";
import { Semantic } from "./semantic.tsx";
import { Skill } from "./skill.tsx";

export function StateView({ inspected }: { inspected: InspectedState }) {
  const { path, state } = inspected;
  const hasScript = state.kind === "execution" || state.kind === "decider";
  return (
    <>
      <InRun inspected={inspected} />
      <General inspected={inspected} />
      <Description key={`description ${path}`} inspected={inspected} />
      {hasScript && <Script key={`script ${path}`} inspected={inspected} />}
      <Ports key={`inputs ${path}`} inspected={inspected} kind="input" />
      <Ports key={`outputs ${path}`} inspected={inspected} kind="output" />
      {isContainer(state) && (
        <Ports key={`scoped ${path}`} inspected={inspected} kind="scoped_variable" />
      )}
      <Outcomes key={`outcomes ${path}`} inspected={inspected} />
      <Connections key={`transitions ${path}`} inspected={inspected} kind="transition" />
      <Connections key={`flows ${path}`} inspected={inspected} kind="data_flow" />
      <LostLink key={`lost link ${path}`} inspected={inspected} />
      <Skill key={`skill ${path}`} inspected={inspected} />
      <Semantic key={`semantic ${path}`} inspected={inspected} />
      <Place key={`place ${path}`} inspected={inspected} />
    </>
  );
}
