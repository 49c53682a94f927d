/** Durations as short texts with stable widths. */

const SECOND = 1_000;
const MINUTE = 60 * SECOND;

/** Short form: `4 µs`, `42 ms`, `0.1 s`, `3.4 s`, `12 s`, `3:05`, `1:02:03`, `2 d 1:02:03`. */
export function duration(ms: number): string {
  if (ms < 0) return `−${duration(-ms)}`;
  if (ms === 0) return "0 s";
  if (ms < 0.9995) return `${Math.round(ms * 1_000)} µs`;
  if (ms < 99.95) return `${ms < 9.95 ? ms.toFixed(1) : Math.round(ms)} ms`;
  if (ms < 9_950) return `${(ms / SECOND).toFixed(1)} s`;
  if (ms < MINUTE - 500) return `${Math.round(ms / SECOND)} s`;
  const seconds = Math.round(ms / SECOND);
  const days = Math.floor(seconds / 86_400);
  const [hours, minutes] = [Math.floor(seconds / 3_600) % 24, Math.floor(seconds / 60) % 60];
  const rest = two(seconds % 60);
  if (days > 0) return `${days} d ${hours}:${two(minutes)}:${rest}`;
  return hours > 0 ? `${hours}:${two(minutes)}:${rest}` : `${minutes}:${rest}`;
}

/** Three significant figures, for comparisons: `4 µs`, `1.05 ms`, `251 ms`, `3.42 s`, `12.3 s`, `3:05`. */
export function measured(ms: number): string {
  if (ms < 0) return `−${measured(-ms)}`;
  if (ms < 0.9995 || ms >= MINUTE - 50) return duration(ms);
  return ms < 999.5 ? `${threeFigures(ms)} ms` : `${threeFigures(ms / SECOND)} s`;
}

function threeFigures(number: number): string {
  return number.toFixed(number < 9.995 ? 2 : number < 99.95 ? 1 : 0);
}

/** Duration that is still growing, rounded down, with tenths below 10 s: `0.6 s`, `9.9 s`, `12 s`. */
export function growing(ms: number): string {
  if (ms < 10 * SECOND) return `${(Math.floor(Math.max(0, ms) / 100) / 10).toFixed(1)} s`;
  return duration(Math.floor(ms / SECOND) * SECOND);
}

function two(number: number): string {
  return String(number).padStart(2, "0");
}
