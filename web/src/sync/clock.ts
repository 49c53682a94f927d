/** Time, as the connection knows it: tests bring their own. */

export interface Clock {
  /** ms since 1970. */
  readonly now: () => number;
  /** Calls once after this time in ms, unless the returned function is called before. */
  readonly after: (ms: number, call: () => void) => () => void;
}

export const WALL_CLOCK: Clock = {
  now: () => Date.now(),
  after: (ms, call) => {
    const timer = setTimeout(call, ms);
    return () => clearTimeout(timer);
  },
};
