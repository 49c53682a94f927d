/** Small step controls on the canvas, one at the place where each branch is held: there one steps that branch alone. */

import { ArrowDownToLine, ArrowRightToLine, ArrowUpFromLine, Undo2 } from "lucide-react";
import { useEffect, useRef } from "react";
import { screenBox } from "../canvas/camera/camera.ts";
import type { CanvasPicture } from "../canvas/picture.ts";
import type { Box } from "../model/geometry.ts";
import { namesTo } from "../model/machine.ts";
import { parentOf } from "../model/path.ts";
import type { Watch } from "../store/history/run.ts";
import type { OpenTab } from "../store/page/page.ts";
import { type Active, activeStates, lanes, placeOfLane } from "../store/run/active.ts";
import { IconButton } from "../ui/button.tsx";
import { isSameList, useComputed } from "../ui/signals.ts";
import { useSession } from "./session_context.tsx";
import "./branch_steps.css";

const STEPS = [
  ["run.back", Undo2],
  ["run.into", ArrowDownToLine],
  ["run.over", ArrowRightToLine],
  ["run.out", ArrowUpFromLine],
] as const;

interface BranchStepsProps {
  readonly tab: OpenTab;
  readonly watch: Watch;
  readonly picture: CanvasPicture;
}

export function BranchSteps({ tab, watch, picture }: BranchStepsProps) {
  const held = useComputed(() => heldLanes(watch), [watch], isSameHeld);
  return held.map((lane) => (
    <At key={placeOfLane(lane)} path={placeOfLane(lane)} tab={tab} picture={picture}>
      <Steps tab={tab} lane={lane} />
    </At>
  ));
}

/** The branches of concurrency states that are held, while what is shown is live. */
function heldLanes(watch: Watch): readonly Active[] {
  if (watch.playhead.value !== null) return [];
  return lanes(activeStates(watch)).filter(
    ({ phase, branch }) => phase === "held" && branch !== "",
  );
}

function isSameHeld(one: readonly Active[], other: readonly Active[]): boolean {
  return isSameList(
    one,
    other,
    (lane, now) => lane.branch === now.branch && placeOfLane(lane) === placeOfLane(now),
  );
}

function Steps({ tab, lane }: { readonly tab: OpenTab; readonly lane: Active }) {
  const { commands, context } = useSession();
  const name = namesTo(tab.session.machine, lane.branch).at(-1) ?? lane.branch;
  return (
    <div className="branch-steps" role="toolbar" aria-label={`Step ${name}`}>
      {STEPS.map(([id, Icon]) => (
        <IconButton
          key={id}
          label={`${commands.get(id)?.title ?? id}: ${name} only`}
          icon={<Icon size={13} />}
          onClick={() => commands.run(id, context(), lane.branch)}
        />
      ))}
    </div>
  );
}

/** Below the smallest box around a place that can be seen and that the controls are not larger than. */
function At({
  path,
  tab,
  picture,
  children,
}: Omit<BranchStepsProps, "watch"> & {
  readonly path: string;
  readonly children: React.ReactNode;
}) {
  const place = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const put = () => {
      const at = boxOnScreen(tab, picture, path);
      const { style } = place.current ?? {};
      if (!style) return;
      const size = picture.size();
      const isSeen =
        at !== null && at.x < size.width && at.y < size.height && at.x + at.width > 0 && at.y > -30;
      style.visibility = isSeen ? "visible" : "hidden";
      if (at) style.transform = `translate(${at.x}px, ${at.y + at.height + 4}px)`;
    };
    put();
    return picture.onFrame(put);
  }, [tab, picture, path]);
  return (
    <div ref={place} className="branch-steps-place">
      {children}
    </div>
  );
}

/** Boxes smaller than this, in CSS pixels, are too small to have controls of their own. */
const LEAST = 24;

function boxOnScreen({ view }: OpenTab, picture: CanvasPicture, path: string): Box | null {
  for (let at: string | null = path; at !== null; at = parentOf(at)) {
    const box = picture.layout().box(at);
    const on = box && screenBox(view.camera.peek(), box);
    if (on && Math.min(on.width, on.height) >= LEAST) return on;
  }
  return null;
}
