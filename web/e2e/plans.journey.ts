/** Whatever the page plans, the server takes: random plans on growing machines, each refused by the page or made; and what the page
 * shows of it before the answer is what the server then has. The plans are others each day; `RAFCON_SEEDS_FROM` sets their seed. */

import fc from "fast-check";
import { afterAll, beforeAll, expect, test } from "vitest";
import type { ElementRef } from "../src/model/element.ts";
import { endsOf, isConnection } from "../src/model/ends.ts";
import type { Document, Edit } from "../src/model/generated/protocol.ts";
import { type Box, boundsOf, contains } from "../src/model/geometry.ts";
import type { Machine } from "../src/model/machine.ts";
import { dataFlowsOf, outcomesOf, portsOf, transitionsOf } from "../src/model/machine.ts";
import { childPath, idOf, lineage, parentOf } from "../src/model/path.ts";
import { machineOf } from "../src/model/plain_machine.ts";
import { boxIn } from "../src/plan/boxes.ts";
import { copySelection, duplicate, paste } from "../src/plan/clipboard.ts";
import {
  connect,
  connectFromSibling,
  connectToParent,
  connectToSibling,
  connectToState,
  reconnect,
} from "../src/plan/connect.ts";
import { documentsOf } from "../src/plan/documents.ts";
import { addTemplate, group, substitute } from "../src/plan/group.ts";
import { insertState } from "../src/plan/insert.ts";
import { align, distribute, move, moveInto, resize } from "../src/plan/move.ts";
import { isRefused, type Planned } from "../src/plan/plan.ts";
import { addOutcome, addPort, renamePort, setPortType } from "../src/plan/ports.ts";
import {
  addState,
  changeKind,
  removeElements,
  rename,
  setId,
  setStart,
} from "../src/plan/states.ts";
import { ungroup } from "../src/plan/ungroup.ts";
import { OptimisticDocument } from "../src/store/document/optimistic_document.ts";
import { predictedWrites } from "../src/store/document/predict/predict.ts";
import { examples, newPlace } from "./support/places.ts";
import { Server } from "./support/server.ts";

const MACHINES = [
  "hierarchy_and_data",
  "barrier_with_decider",
  "preemptive_with_timer",
  "library_reuse",
  "error_recovery",
] as const;

/** The date as a number, such as 20261231. */
const TODAY = new Date().toISOString().slice(0, 10).replaceAll("-", "");
const SEED = Number(process.env["RAFCON_SEEDS_FROM"] ?? TODAY);

let server: Server;

beforeAll(async () => {
  server = await Server.start(newPlace(examples(...MACHINES)));
});

afterAll(async () => {
  await server?.dispose();
});

/** Chooses by numbers, so that the same numbers make the same plans. */
class Dice {
  readonly #numbers: readonly number[];
  #next = 0;

  constructor(numbers: readonly number[]) {
    this.#numbers = numbers;
  }

  roll(sides: number): number {
    const number = this.#numbers[this.#next++ % this.#numbers.length] ?? 0;
    return number % Math.max(1, sides);
  }

  one<T>(items: readonly T[]): T | undefined {
    return items[this.roll(items.length)];
  }

  some<T>(items: readonly T[]): T[] {
    return items.filter(() => this.roll(2) === 0);
  }
}

function elements(machine: Machine): readonly ElementRef[] {
  return [...machine.paths()].flatMap((path): ElementRef[] => {
    const state = machine.state(path);
    if (!state) return [];
    const of = (
      kind: "outcome" | "input" | "output" | "scoped_variable" | "transition" | "data_flow",
      list: readonly { id: number }[],
    ) => list.map(({ id }): ElementRef => ({ kind, path, id }));
    return [
      { kind: "state", path },
      { kind: "income", path },
      ...of("outcome", outcomesOf(state)),
      ...of("input", portsOf(state, "input")),
      ...of("output", portsOf(state, "output")),
      ...of("scoped_variable", portsOf(state, "scoped_variable")),
      ...of("transition", transitionsOf(state)),
      ...of("data_flow", dataFlowsOf(state)),
    ];
  });
}

const TYPES = ["int", "float", "str", "list", "object", "numpy.ndarray"];
const KINDS = ["execution", "hierarchy", "barrier", "preemptive"] as const;

/** Any plan, sensible or not. */
function anyPlan(machine: Machine, dice: Dice): Planned {
  const all = elements(machine);
  const paths = [...machine.paths()];
  const any = (...kinds: ElementRef["kind"][]) =>
    dice.one(all.filter(({ kind }) => kinds.includes(kind))) ?? {
      kind: "state",
      path: machine.root,
    };
  const path = dice.one(paths) ?? machine.root;
  const other = dice.one(paths) ?? machine.root;
  const siblings = dice.some(machine.children(other));
  const at = { x: dice.roll(100), y: dice.roll(100) };
  const kind = dice.one(KINDS) ?? "execution";
  const plans: readonly (() => Planned)[] = [
    () => addState(machine, path, kind, at),
    () => addState(machine, path, kind),
    () => addOutcome(machine, path),
    () =>
      addPort(machine, path, dice.one(["input", "output", "scoped_variable"] as const) ?? "input", {
        data_type: dice.one(TYPES) ?? "int",
      }),
    () =>
      addPort(machine, path, dice.one(["input", "output", "scoped_variable"] as const) ?? "input"),
    () => setPortType(machine, any("input", "output", "scoped_variable"), dice.one(TYPES) ?? "int"),
    () => renamePort(machine, any("input", "output", "scoped_variable"), `name${dice.roll(5)}`),
    () => rename(machine, path, `Name ${dice.roll(5)}`),
    () => setId(machine, path, `ID${dice.roll(9)}`),
    () =>
      removeElements(
        machine,
        dice.roll(4) === 0 ? [any("state")] : [any("transition", "data_flow", "input", "outcome")],
      ),
    () => changeKind(machine, path, kind),
    () => setStart(machine, path),
    () => connect(machine, any("outcome", "income"), any("income", "outcome", "state")),
    () => connect(machine, any("outcome", "income"), any("income", "outcome", "state")),
    () =>
      connect(
        machine,
        any("input", "output", "scoped_variable"),
        any("input", "output", "scoped_variable"),
      ),
    () =>
      connect(
        machine,
        any("input", "output", "scoped_variable"),
        any("input", "output", "scoped_variable"),
      ),
    () => connectToState(machine, any("input", "output", "scoped_variable", "outcome"), path),
    () =>
      reconnect(
        machine,
        any("transition", "data_flow"),
        dice.one(["from", "to"] as const) ?? "to",
        any("income", "outcome", "input", "output", "scoped_variable", "state"),
      ),
    () => insertState(machine, any("transition"), dice.roll(2) === 0 ? path : { kind }, at),
    () => connectToSibling(machine, path),
    () => connectFromSibling(machine, path),
    () => connectToParent(machine, path),
    () =>
      group(
        machine,
        siblings,
        dice.some(
          portsOf(
            machine.state(other) ?? { path: "", name: "", kind: "execution" },
            "scoped_variable",
          ).map(({ id }) => id),
        ),
      ),
    () => ungroup(machine, path),
    () => substitute(machine, path, documentsOf(machine, other), dice.roll(2) === 0),
    () => addTemplate(machine, path, documentsOf(machine, other), at),
    () => move(machine, siblings, at),
    () => moveInto(machine, siblings, path, at),
    () =>
      resize(
        machine,
        path,
        { ...at, width: 1 + dice.roll(90), height: 1 + dice.roll(90) },
        dice.roll(2) === 0,
      ),
    () => align(machine, siblings, "left"),
    () => distribute(machine, siblings, "vertical"),
    () => duplicate(machine, siblings, at),
    () => {
      const selection = copySelection(
        machine,
        siblings.map((each) => ({ kind: "state", path: each })),
      );
      return isRefused(selection) ? selection : paste(machine, path, selection, at);
    },
  ];
  return dice.one(plans)?.() ?? { refused: "no plan" };
}

interface Opened {
  readonly id: string;
}

interface DocumentResponse {
  readonly document: Document;
}

/** Gives how many plans were made, and how many of them were predicted. */
async function walk(
  id: string,
  numbers: readonly number[][],
): Promise<{ readonly made: number; readonly predicted: number }> {
  let [made, predicted] = [0, 0];
  for (const [index, each] of numbers.entries()) {
    const { document } = await server.ask<DocumentResponse>("GET", `/machines/${id}/document`);
    if (document.states.length > 300) break;
    const machine = machineOf(document);
    const shown = new OptimisticDocument(document, () => undefined);
    const planned = anyPlan(machine, new Dice(each));
    if (isRefused(planned)) {
      expect(planned.refused.length).toBeGreaterThan(20);
      continue;
    }
    const writes = predictedWrites(shown, planned.edit);
    await make(id, `${index}-${each.join()}`, planned.name, planned.edit);
    made++;
    if (writes) {
      shown.transact(() => shown.applyOptimistic(writes));
      await showedWhatIs(id, shown, planned);
      predicted++;
    }
    if (planned.name.startsWith("Group "))
      await staysInSight(id, machine, planned.select?.[0]?.path);
    if (planned.name.startsWith("Ungroup ")) await staysInSight(id, machine, undefined);
    await lookAt(id, planned.select ?? []);
  }
  return { made, predicted };
}

/** What was shown before the answer is what the server has after it. */
async function showedWhatIs(
  id: string,
  shown: OptimisticDocument,
  { name, edit }: Exclude<Planned, { readonly refused: string }>,
): Promise<void> {
  const { document } = await server.ask<DocumentResponse>("GET", `/machines/${id}/document`);
  const about = `${name}: ${JSON.stringify(edit).slice(0, 3000)}`;
  const paths = [...shown.paths()];
  expect(paths, about).toEqual(document.states.map(({ path }) => path));
  for (const state of document.states) expect(shown.state(state.path), about).toEqual(state);
  expect(shown.header, about).toEqual(document.header);
}

async function make(id: string, edit_id: string, name: string, edit: Edit): Promise<void> {
  try {
    await server.ask("POST", `/machines/${id}/edits`, { id: edit_id, base: null, name, edit });
  } catch (error) {
    throw new Error(`${name}: ${String(error)}\n${JSON.stringify(edit).slice(0, 3000)}`);
  }
}

/** What is to be selected is there, and so are both ends of every connection. */
async function lookAt(id: string, selected: readonly ElementRef[]): Promise<void> {
  const machine = machineOf(
    (await server.ask<DocumentResponse>("GET", `/machines/${id}/document`)).document,
  );
  for (const { path } of selected) expect(machine.state(path), path).toBeDefined();
  for (const element of elements(machine)) {
    if (isConnection(element)) expect(endsOf(machine, element), element.path).not.toBeNull();
  }
}

/** Everything that is still there shows where it was. Only the content of a group for which there is no room is made smaller,
 * and stays in the bounds that it had. */
async function staysInSight(id: string, before: Machine, group: string | undefined): Promise<void> {
  const machine = machineOf(
    (await server.ask<DocumentResponse>("GET", `/machines/${id}/document`)).document,
  );
  const bounds = group === undefined ? null : boundsIfSmaller(before, machine, group);
  const now = placesById(machine);
  for (const [state, was] of placesById(before)) {
    const then = now.get(state);
    if (!then) continue;
    if (bounds && then.path.startsWith(`${group}/`)) {
      if (parentOf(then.path) !== group) continue;
      expect(contains(bounds, then.box), `${state} in its bounds`).toBe(true);
      continue;
    }
    expect(then.box.x, `${state} in x`).toBeCloseTo(was.box.x, 3);
    expect(then.box.y, `${state} in y`).toBeCloseTo(was.box.y, 3);
  }
}

/** The bounds that the states of a new group had, if they are smaller now. */
function boundsIfSmaller(before: Machine, now: Machine, group: string): Box | null {
  const container = parentOf(group) ?? before.root;
  const boxes = now.children(group).map((path) => ({
    was: boxInRoot(before, childPath(container, idOf(path))),
    is: boxInRoot(now, path),
  }));
  const isSmaller = boxes.some(({ was, is }) => is.width < was.width * 0.999);
  return isSmaller ? boundsOf(boxes.map(({ was }) => was)) : null;
}

interface Place {
  readonly path: string;
  readonly box: Box;
}

/** Where states stand in the root's coordinates, by ids that only one state has. */
function placesById(machine: Machine): ReadonlyMap<string, Place> {
  const places = new Map<string, Place>();
  const twice = new Set<string>();
  for (const path of machine.paths()) {
    const id = idOf(path);
    if (places.has(id)) twice.add(id);
    places.set(id, { path, box: boxInRoot(machine, path) });
  }
  for (const id of twice) places.delete(id);
  return places;
}

function boxInRoot(machine: Machine, path: string): Box {
  const boxes = lineage(path)
    .slice(1)
    .map((each) => boxIn(machine, each));
  const x = boxes.reduce((sum, box) => sum + box.x, 0);
  const y = boxes.reduce((sum, box) => sum + box.y, 0);
  return { ...boxIn(machine, path), x, y };
}

test.each(MACHINES)(
  "plans for %s are taken by the server, and come to what was shown",
  async (path) => {
    const project = (await server.ask<{ id: string }[]>("GET", "/projects"))[0]?.id;
    const { id } = await server.ask<Opened>("POST", "/machines/open", {
      file: { project, path },
    });
    const seed = SEED + MACHINES.indexOf(path);
    const numbers = fc.sample(fc.array(fc.nat(9999), { minLength: 24, maxLength: 24 }), {
      seed,
      numRuns: 400,
    });
    try {
      const { made, predicted } = await walk(id, numbers);
      expect(made).toBeGreaterThan(100);
      expect(predicted).toBeGreaterThan(made / 2);
    } catch (error) {
      throw new Error(`with RAFCON_SEEDS_FROM=${SEED}: ${String(error)}`, { cause: error });
    }
  },
);
