/** Timeouts of journeys. They are generous, because a busy computer is no fault and a wait that succeeds costs nothing more. No journey
 * has a timeout of its own. */

/** For whatever has to come. */
export const WAIT_MS = 120_000;

/** For a journey, which waits many times. */
export const JOURNEY_MS = 600_000;

/** The same as an option of `vi.waitUntil` and `expect.poll`. */
export const PATIENCE = { timeout: WAIT_MS, interval: 50 };

/** For what takes minutes by itself, such as a run of 200,000 events. */
export const LONG_WORK = { timeout: 3 * WAIT_MS, interval: 200 };
