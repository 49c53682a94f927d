/** When a picture of the page can be taken. */

import type { Page as Sheet } from "playwright-core";

/** Waits until nothing was drawn for a while: nothing moves any more, and all ways of lines are found. While a run goes on there is
 * always something; then so long is enough. */
export async function settled(sheet: Sheet, most_ms = Number.MAX_VALUE): Promise<void> {
  await sheet.evaluate(
    (most) =>
      new Promise<void>((done) => {
        const begun = performance.now();
        let last = begun;
        const seen = new PerformanceObserver(() => {
          last = performance.now();
        });
        seen.observe({ type: "measure" });
        const look = () => {
          const now = performance.now();
          if (now - last < 400 && now - begun < most) requestAnimationFrame(look);
          else {
            seen.disconnect();
            done();
          }
        };
        requestAnimationFrame(look);
      }),
    most_ms,
  );
}
