/** Visible part of a run's time, and its movements: zoom, pan, fit, and following the end. */

export interface TimeSpan {
  readonly from_ns: number;
  readonly to_ns: number;
}

/** Requested span: null for the whole run, or a part, which may follow the end. */
export type SpanRequest = null | (TimeSpan & { readonly isFollowing: boolean });

/** Shortest part. */
const SHORTEST_NS = 2_000;
/** Free space at the end of the whole run, as a share of its length. */
const ROOM = 0.02;

/** Visible span of a run of this length. */
export function spanOf(spanRequest: SpanRequest, end_ns: number): TimeSpan {
  const whole = { from_ns: 0, to_ns: Math.max(SHORTEST_NS, end_ns * (1 + ROOM)) };
  if (spanRequest === null) return whole;
  if (!spanRequest.isFollowing) return spanRequest;
  const length = spanRequest.to_ns - spanRequest.from_ns;
  return { from_ns: Math.max(0, whole.to_ns - length), to_ns: whole.to_ns };
}

/** Shows `factor` times as much, and keeps the time `at_ns` in place. */
export function zoomed(span: TimeSpan, factor: number, at_ns: number, end_ns: number): SpanRequest {
  const whole = spanOf(null, end_ns);
  const length = Math.max(SHORTEST_NS, (span.to_ns - span.from_ns) * factor);
  if (length >= whole.to_ns) return null;
  const part = (at_ns - span.from_ns) / (span.to_ns - span.from_ns);
  return held({ from_ns: at_ns - part * length, to_ns: at_ns + (1 - part) * length }, end_ns);
}

export function panned(span: TimeSpan, by_ns: number, end_ns: number): SpanRequest {
  return held({ from_ns: span.from_ns + by_ns, to_ns: span.to_ns + by_ns }, end_ns);
}

/** Shows this part with a margin on each side. */
export function fitted(part: TimeSpan, end_ns: number): SpanRequest {
  const room = Math.max(SHORTEST_NS, part.to_ns - part.from_ns) * 0.1;
  return held({ from_ns: part.from_ns - room, to_ns: part.to_ns + room }, end_ns);
}

/** Moves the span until a time is visible. The request is unchanged if it already is. */
export function withTime(spanRequest: SpanRequest, at_ns: number, end_ns: number): SpanRequest {
  const span = spanOf(spanRequest, end_ns);
  if (at_ns >= span.from_ns && at_ns <= span.to_ns) return spanRequest;
  return panned(span, at_ns - (span.from_ns + span.to_ns) / 2, end_ns);
}

/** Limits the span to the run. A span at the end follows the run. */
function held(span: TimeSpan, end_ns: number): SpanRequest {
  const whole = spanOf(null, end_ns);
  const length = span.to_ns - span.from_ns;
  if (length >= whole.to_ns) return null;
  const from_ns = Math.min(Math.max(0, span.from_ns), whole.to_ns - length);
  const isFollowing = from_ns + length >= end_ns && from_ns + length >= whole.to_ns * (1 - 1e-9);
  return { from_ns, to_ns: from_ns + length, isFollowing };
}

const STEPS = [1, 2, 5];

/** Times of the marks on the ruler, at most `most`, and the distance between them in ms. */
export function ticks(
  span: TimeSpan,
  most: number,
): { readonly step_ms: number; readonly at_ns: readonly number[] } {
  const step_ns = stepFor((span.to_ns - span.from_ns) / Math.max(1, most));
  const first = Math.ceil(span.from_ns / step_ns);
  const count = Math.max(0, Math.floor(span.to_ns / step_ns) - first + 1);
  const at_ns = Array.from({ length: count }, (_, index) => (first + index) * step_ns);
  return { step_ms: step_ns / 1e6, at_ns };
}

const MINUTES_NS = [15, 30, 60, 120, 300, 600, 900, 1_800, 3_600].map((seconds) => seconds * 1e9);

/** Smallest round length of at least `least_ns`. */
function stepFor(least_ns: number): number {
  if (least_ns > 10e9) {
    const found = MINUTES_NS.find((step) => step >= least_ns);
    return found ?? Math.ceil(least_ns / 3_600e9) * 3_600e9;
  }
  const power = 10 ** Math.floor(Math.log10(Math.max(1, least_ns)));
  return (STEPS.find((step) => step * power >= least_ns) ?? 10) * power;
}
