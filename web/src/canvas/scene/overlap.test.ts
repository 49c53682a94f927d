import { expect, test } from "vitest";
import { contains } from "../../model/geometry.ts";
import { machineOf } from "../../model/plain_machine.ts";
import { sketch } from "../../model/testing/sketch.ts";
import { MODES } from "../../store/page/view.ts";
import type { RunMark } from "../../store/run/marks.ts";
import { layoutTreeOf } from "../layout/layout_tree.ts";
import { NO_OVERLAY } from "../overlay.ts";
import { PLAIN } from "./input.ts";
import type { TextMark } from "./list.ts";
import { scene } from "./scene.ts";

/** Containers in each other, each with little room above its first child, as a mission has them. */
const MACHINE = machineOf(
  sketch(`
    R "Mission" hierarchy 0 0 1600 1000 outcome done output report:str
      E "Explore" barrier 60 50 1480 900 outcome success output seen:int
        S "Survey" hierarchy 60 60 1100 800 outcome success output seen:int input seed:int
          A "Sector 1" preemptive 60 50 480 330 outcome surveyed input sizes:list
            V "Visit the waypoints" hierarchy 30 24 420 280 outcome visited
              W "Waypoint 1" hierarchy 20 20 120 80 outcome done input x_m:float
                D "Drive there" execution 10 10 30 20 outcome arrived
                W > D
                D.arrived > W.done
              X "Waypoint 2" execution 160 20 120 80 outcome done input x_m:float
              Y "Waypoint 3" execution 290 20 120 80 outcome done
              V > W
              W.done > X
              X.done > Y
              Y.done > V.visited
            B "Watch the battery" execution 30 306 60 20 outcome low
          C "Sector 2" preemptive 580 30 480 330 outcome surveyed
            U "Visit the waypoints" hierarchy 30 24 420 280 outcome visited
          F "Charge" execution 60 500 200 160 outcome success
          S > A
          A.surveyed > C
          C.surveyed > F
          F.success > S.success
        K "Keep in touch" hierarchy 1180 60 240 800 outcome success
      R > E
      E.success > R.done
  `),
);

const MARK: RunMark = {
  phase: "running",
  mostUrgent: "running",
  mostUrgentActive: "running",
  isLeaf: false,
  lanes: 2,
  age: 0,
  since_ms: 83_000,
  preempted: false,
  failed: true,
  detail: null,
};

const PATHS = [...MACHINE.paths()];
const LAYOUT = layoutTreeOf(MACHINE, { modes: MODES, contents: new Map() });

interface Shown {
  readonly isRunning: boolean;
  readonly isWatched: boolean;
}

function textsOf(scale: number, x: number, y: number, { isRunning, isWatched }: Shown) {
  const { layers } = scene({
    ...PLAIN,
    layout: LAYOUT,
    camera: { x, y, scale },
    view: { width: 1_000, height: 640 },
    modes: MODES,
    overlay: NO_OVERLAY,
    measure: (text, size) => text.length * size * 0.52,
    runs: new Map(isRunning ? PATHS.map((path) => [path, MARK] as const) : []),
    visits: () => (isRunning ? 12 : 0),
    people: isWatched ? PATHS.map((path) => ({ name: "Anna", colour: 1, selection: [path] })) : [],
  });
  return layers.flatMap(({ texts }) => texts);
}

interface Area {
  readonly left: number;
  readonly right: number;
  readonly top: number;
  readonly bottom: number;
}

/** What a text covers: its letters, and the plate behind them. */
function areaOf({ x, y, align, width, size, plate, lead, text }: TextMark): Area {
  const wide = width || text.length * size * 0.52;
  const left = align === "left" ? x : align === "right" ? x - wide : x - wide / 2;
  const [beside, half] = plate === null ? [0, size * 0.4] : [4, (size + 5) / 2];
  return {
    left: left - beside - (lead ?? 0),
    right: left + wide + beside,
    top: y - half,
    bottom: y + half,
  };
}

/** The letters of a name, without its plate. */
function lettersOf(name: TextMark): Area {
  return areaOf({ ...name, plate: null, lead: 0 });
}

function overlaps(one: Area, other: Area): boolean {
  return (
    one.left < other.right - 0.5 &&
    other.left < one.right - 0.5 &&
    one.top < other.bottom - 0.5 &&
    other.top < one.bottom - 0.5
  );
}

/** Names that something else is written upon in a view. */
function coveredIn(texts: readonly TextMark[]): readonly string[] {
  const names = texts.filter(({ what }) => /^state:\S+ name$/.test(what));
  return names.flatMap((name) =>
    texts
      .filter(({ what }) => what !== name.what)
      .filter((other) => overlaps(lettersOf(name), areaOf(other)))
      .map((other) => `${other.what} “${other.text}” on ${name.text}`),
  );
}

/** The same anywhere in the machine, at any size. */
function covered(shown: Shown): readonly string[] {
  const found = new Set<string>();
  for (let scale = 0.05; scale < 12; scale *= 1.17) {
    const step = Math.max(90, 400 / scale);
    for (let x = -60; x < 1_600; x += step) {
      for (let y = -60; y < 1_000; y += step) {
        for (const each of coveredIn(textsOf(scale, x, y, shown))) {
          found.add(`${each} at ${scale.toFixed(2)}`);
        }
      }
    }
  }
  return [...found];
}

/** Names of containers that lie on a state inside, away from the corner that tells whose names they are. */
function astray(): readonly string[] {
  const found = new Set<string>();
  for (let scale = 0.05; scale < 12; scale *= 1.17) {
    for (const { what, text, x, y, plate } of textsOf(scale, -20, -20, PLAINLY)) {
      const path = /^state:(\S+) name$/.exec(what)?.[1];
      const box = path && LAYOUT.box(path);
      if (!path || !box || plate === null) continue;
      const isOwn = x - (box.x + 20) * scale < 60 && y - (box.y + 20) * scale < 20;
      const at = { x: x / scale - 20, y: y / scale - 20 };
      const child = PATHS.find((each) => {
        const inner = each.startsWith(`${path}/`) && LAYOUT.box(each);
        return inner && contains(inner, at);
      });
      if (!isOwn && child) found.add(`${text} on ${child} at ${scale.toFixed(2)}`);
    }
  }
  return [...found];
}

const PLAINLY: Shown = { isRunning: true, isWatched: false };

test("the name of a container lies on no state inside, but in the container's own corner", () => {
  expect(astray()).toEqual([]);
});

test.each([
  { isRunning: false, isWatched: false },
  { isRunning: true, isWatched: false },
  { isRunning: false, isWatched: true },
])("no text lies on the name of a state: %o", (shown) => {
  expect(covered(shown)).toEqual([]);
});
