import { signal } from "@preact/signals-core";
import { expect, test } from "vitest";
import type { HistoryEntry, Moment } from "../../model/generated/protocol.ts";
import { Journal } from "../history/journal.ts";
import type { RunSnapshot, Watch } from "../history/run.ts";
import { stateStatusOf } from "./state_status.ts";

const END = { id: 0, name: "success" };

function entry(sequence: number, event: HistoryEntry["event"]): HistoryEntry {
  return { sequence, t_ns: sequence * 1e6, event };
}

const EVENTS = [
  entry(1, { type: "entered", path: "R" }),
  entry(2, { type: "entered", path: "R/A" }),
  entry(3, { type: "left", path: "R/A", outcome: END }),
  entry(4, { type: "entered", path: "R/A" }),
  entry(5, { type: "left", path: "R/A", outcome: { id: -1, name: "aborted" } }),
];

/** The picture after event 4: `R/A` runs for the second time. */
const PICTURE = {
  sequence: 4,
  t_ns: 4e6,
  active: [
    {
      path: "R",
      names: "R",
      depth: 0,
      entered: 1,
      since_ns: 1e6,
      inputs: {},
      scoped: { n: 7 },
      ended: [
        { path: "R/A", names: "R/A", outcome: END, outputs: { x: 1 }, error: null, sequence: 3 },
      ],
    },
    {
      path: "R/A",
      names: "R/A",
      depth: 1,
      entered: 4,
      since_ns: 4e6,
      inputs: { n: 7 },
      scoped: {},
      ended: [],
    },
  ],
  held: [],
  waiting: {},
  questions: [],
} as unknown as Moment;

function watchAt(playhead: number | null): Watch {
  const journal = new Journal();
  journal.add(EVENTS, 6);
  const snapshot: RunSnapshot = { picture: PICTURE, at_ms: 0 };
  return {
    journal,
    window: journal,
    journalVersion: signal(5),
    playhead: signal(playhead),
    playheadSnapshot: signal(snapshot),
    now: signal(null),
  } as unknown as Watch;
}

test("at a moment: how often it ran, how it ended last, and its values from the picture", () => {
  const found = stateStatusOf(watchAt(4), "R/A");
  expect(found.visits).toBe(2);
  expect(found.active?.phase).toBe("running");
  expect(found.entered?.sequence).toBe(4);
  expect(found.left?.outcome?.name).toBe("success");
  expect(found.inputs).toEqual({ n: 7 });
  expect(found.outputs).toEqual({ x: 1 });
  expect(stateStatusOf(watchAt(4), "R").scoped).toEqual({ n: 7 });
});

test("values of another moment are not taken for those of this one", () => {
  const found = stateStatusOf(watchAt(3), "R/A");
  expect(found.entered?.sequence).toBe(2);
  expect([found.inputs, found.outputs]).toEqual([undefined, undefined]);
});

test("live, an older picture gives no outputs of an end that is newer", () => {
  const found = stateStatusOf(watchAt(null), "R/A");
  expect(found.left?.outcome?.name).toBe("aborted");
  expect(found.outputs).toBeUndefined();
  expect(found.inputs).toEqual({ n: 7 });
});
