/** Legend of the heat colours over the canvas. */

import { HEAT_LEVELS } from "../canvas/scene/input.ts";
import { duration } from "../panels/parts/duration.ts";
import type { OpenTab } from "../store/page/page.ts";
import { useComputed, useSignal } from "../ui/signals.ts";

import { heatNow } from "./run_overlay.ts";
import "./heat_legend.css";

const SHADES = Array.from({ length: HEAT_LEVELS + 1 }, (_, level) => level);

export function HeatLegend({ tab }: { readonly tab: OpenTab }) {
  const mode = useSignal(tab.view.heat);
  const most = useComputed(() => heatNow(tab)?.most ?? null, [tab]);
  const isPast = useComputed(() => (tab.run.value?.playhead.value ?? null) !== null, [tab]);
  if (mode === "off" || most === null) return null;
  const [what, least, much] =
    mode === "count"
      ? ["Executions per state", "1×", `${most.toLocaleString("en")}×`]
      : ["Total time per state", "0 s", duration(most)];
  const when = isPast ? ", up to this moment" : "";
  return (
    <div className="heat-legend" role="img" aria-label={`${what}${when}: from ${least} to ${much}`}>
      <span>
        {what}
        {when}
      </span>
      <span className="heat-legend-scale">
        <span>{least}</span>
        {SHADES.map((level) => (
          <span
            key={level}
            className="heat-legend-shade"
            style={{
              background: `color-mix(in srgb, var(--canvas-heat-high) ${(100 * level) / HEAT_LEVELS}%, var(--canvas-heat-low))`,
            }}
          />
        ))}
        <span>{much}</span>
      </span>
    </div>
  );
}
