/** Planner: the available skills and objects, the goal, the plan with its reasons, and a preview of its machine on the canvas. */

import { useEffect, useMemo, useRef } from "react";
import { containerForPlan, ghostOf } from "../../commands/planner.ts";
import { BROWSER_STORE } from "../../store/local_store.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { mayEdit } from "../../store/page/rights.ts";
import { wordsOf } from "../../store/planner/inputs.ts";
import { type Planner, plannerOf } from "../../store/planner/planner.ts";
import { Empty } from "../../ui/empty.tsx";
import { onDemand } from "../../ui/on_demand.tsx";
import { Section } from "../../ui/section.tsx";
import { useComputed, useSignal } from "../../ui/signals.ts";
import { useActiveTab, useHost } from "../context.tsx";
import { Answer } from "./answer.tsx";
import { Bar } from "./bar.tsx";
import { Objects } from "./objects.tsx";
import { Options } from "./options.tsx";
import { Skills } from "./skills.tsx";
import "./planner.css";

const PddlField = onDemand(async () => (await import("../parts/pddl_field.tsx")).PddlField);

export function PlannerPanel() {
  const tab = useActiveTab();
  const { page } = useHost().context();
  if (!tab) {
    return (
      <Empty
        title="No machine is open"
        text="Open the machine into which a plan is to go, or make a new one."
      />
    );
  }
  if (tab.session.fixed !== null || !mayEdit(page)) {
    return (
      <Empty
        title="This machine cannot be changed here"
        text="A plan becomes a part of a machine: open one that you may edit."
      />
    );
  }
  return <OfTab key={tab.session.id} tab={tab} />;
}

function OfTab({ tab }: { readonly tab: OpenTab }) {
  const { context } = useHost();
  const { page } = context();
  const planner = plannerOf(tab.session, page.server, BROWSER_STORE);
  const inputs = useSignal(planner.inputs);
  const domain = useSignal(planner.domain);
  const words = useMemo(() => wordsOf(domain, inputs), [domain, inputs]);
  const fault = useGhost(tab, planner);
  const answer = useAnswerInSight(planner);
  const plan = () => {
    planner.container.value = containerForPlan(context(), planner.taken.peek());
    void planner.plan();
  };
  return (
    <div className="planner">
      <div className="planner-parts">
        <Skills planner={planner} />
        <Objects planner={planner} />
        <Section title="Facts">
          <PddlField
            label="Facts"
            example="(at rover dock)"
            value={inputs.facts}
            words={words}
            onChange={(facts) => planner.change({ facts })}
            onApply={plan}
          />
        </Section>
        <Section title="Goal">
          <PddlField
            label="Goal"
            example="(holding cup): each line is to be reached"
            value={inputs.goal}
            words={words}
            onChange={(goal) => planner.change({ goal })}
            onApply={plan}
          />
        </Section>
        <Options planner={planner} />
        <div ref={answer}>
          <Answer tab={tab} planner={planner} />
        </div>
      </div>
      <Bar tab={tab} planner={planner} fault={fault} onPlan={plan} />
    </div>
  );
}

/** Previews the plan on the canvas while it is proposed and the panel is visible. Returns the reason why it cannot be inserted. */
function useGhost(tab: OpenTab, planner: Planner): string | null {
  const { context } = useHost();
  const ghost = useComputed(() => ghostOf(tab, planner), [tab, planner]);
  const offered = useRef<unknown>(null);
  useEffect(() => {
    const shown = typeof ghost === "string" ? null : ghost;
    tab.view.ghost.value = shown;
    const found = planner.found.peek();
    if (shown && offered.current !== found) context().canvas?.revealGhost();
    offered.current = shown ? found : null;
  }, [ghost, tab, planner, context]);
  useEffect(
    () => () => {
      tab.view.ghost.value = null;
    },
    [tab],
  );
  return typeof ghost === "string" ? ghost : null;
}

/** Scrolls to a new plan or refusal. */
function useAnswerInSight(planner: Planner) {
  const place = useRef<HTMLDivElement>(null);
  const found = useSignal(planner.found);
  const { state } = useSignal(planner.planning);
  const isRefused = state === "refused";
  useEffect(() => {
    if (found || isRefused) place.current?.scrollIntoView?.({ block: "start" });
  }, [found, isRefused]);
  return place;
}
