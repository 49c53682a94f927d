import { describe, expect, it } from "vitest";
import type { PlanEvent, PlanFound } from "../../model/generated/protocol.ts";
import { memoryStore } from "../local_store.ts";
import { RefusalError } from "../page/server.ts";
import { missingIn, NO_INPUTS, requestOf, withFile, wordsOf } from "./inputs.ts";
import { Planner } from "./planner.ts";

/** A planner with a scripted server. */
function setUp(store = memoryStore()) {
  const asked: unknown[] = [];
  let say: (event: PlanEvent) => void = () => {};
  let end: (error?: Error) => void = () => {};
  let signal: AbortSignal | null = null;
  const server = {
    request: async <T>(_method: string, _path: string, body?: unknown) => {
      asked.push(body);
      return { skills: [], types: {}, predicates: [], functions: [], pddl: "", findings: [] } as T;
    },
    lines: <T>(_: string, body: unknown, tell: (line: T) => void, given: AbortSignal) => {
      asked.push(body);
      signal = given;
      say = (event) => tell(event as T);
      return new Promise<void>((done, failed) => {
        end = (error) => (error ? failed(error) : done());
        given.addEventListener("abort", () => done());
      });
    },
  };
  const planner = new Planner(server, store, "p/m", () => 5_000);
  return {
    planner,
    asked,
    store,
    say: (event: PlanEvent) => say(event),
    end: (error?: Error) => end(error),
    isEnded: () => signal?.aborted === true,
  };
}

function found(...actions: readonly string[]): PlanEvent & PlanFound {
  const steps = actions.map((action, start) => ({
    ...{ action, library: "", title: action, objects: [], start, path: "" },
    needs: [],
    brings: [],
  }));
  const machine = { container: "" };
  const more = { engine: "kairos", after_ms: 1, temporal: false, makespan: 0, lost: 0 };
  return { event: "found", ...more, steps, machine };
}

function stepsOf(plan: PlanFound | null): string | undefined {
  return plan?.steps.map(({ action }) => action).join(" ");
}

const DONE: PlanEvent = { event: "done", reason: "done", after_ms: 3 };

describe("a planner", () => {
  it("keeps the answer to what was asked before, and not worse answers to the same", async () => {
    const { planner, say, end } = setUp();
    const first = planner.plan();
    expect(planner.planning.value).toEqual({ state: "planning", since_ms: 5_000 });
    say(found("a", "b", "c"));
    say(found("a", "b"));
    say(DONE);
    end();
    await first;
    expect(planner.planning.value).toEqual({ state: "done", end: { reason: "done", after_ms: 3 } });
    expect([stepsOf(planner.before.value), stepsOf(planner.found.value)]).toEqual([
      undefined,
      "a b",
    ]);
    const second = planner.plan();
    say(found("x"));
    say(found("y"));
    say(DONE);
    end();
    await second;
    expect([stepsOf(planner.before.value), stepsOf(planner.found.value)]).toEqual(["a b", "y"]);
  });

  it("does not offer an answer to an earlier goal", async () => {
    const { planner, say, end } = setUp();
    planner.change({ goal: "(a)" });
    const first = planner.plan();
    say(found("a"));
    end();
    await first;
    expect(planner.isCurrent.value).toBe(true);
    planner.change({ limit_s: 3 });
    expect(planner.isCurrent.value).toBe(true);
    planner.change({ goal: "(b)" });
    expect(planner.isCurrent.value).toBe(false);
    const second = planner.plan();
    say({ event: "impossible", reason: "no", after_ms: 3 });
    end();
    await second;
    expect(planner.isCurrent.value).toBe(false);
    planner.change({ goal: "(a)" });
    expect(planner.isCurrent.value).toBe(true);
  });

  it("ends the engine when it is cancelled, and heeds nothing that comes later", async () => {
    const { planner, say, isEnded } = setUp();
    const done = planner.plan();
    say(found("a"));
    planner.cancel();
    expect(isEnded()).toBe(true);
    say(found("b"));
    await done;
    expect(planner.planning.value.state).toBe("cancelled");
    expect(stepsOf(planner.found.value)).toBe("a");
  });

  it("tells why it could not ask, and when the server goes away", async () => {
    const { planner, end } = setUp();
    const refusedPlan = planner.plan();
    end(new RefusalError({ code: "too_many_plans", message: "try again later" }, 429));
    await refusedPlan;
    expect(planner.planning.value).toEqual({ state: "unasked", reason: "try again later" });
    const cutOff = planner.plan();
    end();
    await cutOff;
    expect(planner.planning.value).toMatchObject({ state: "unasked" });
  });

  it("keeps what was written for the machine", () => {
    const { planner, store } = setUp();
    planner.change({ goal: "(a)", libraries: ["skills"] });
    expect(setUp(store).planner.inputs.value).toEqual({
      ...NO_INPUTS,
      goal: "(a)",
      libraries: ["skills"],
    });
  });
});

describe("what is asked", () => {
  const inputs = {
    ...NO_INPUTS,
    libraries: ["skills"],
    types: "cup - dish",
    objects: [
      { name: "c", type: "cup", value: '{"x": 1}' },
      { name: "d", type: "", value: "" },
    ],
    facts: "(on c d)",
    goal: "(a)\n(b)",
    limit_s: 0.5,
  };

  it("is a problem, a goal and the values of objects", () => {
    const request = requestOf(inputs);
    expect(request).toMatchObject({
      pool: { libraries: ["skills"], types: { cup: "dish" } },
      goal: "(and (a)\n(b))",
      data: { c: { x: 1 } },
      time_limit_ms: 500,
      name: "Plan",
    });
    expect(request.facts).toContain("c - cup");
    expect(requestOf({ ...inputs, goal: "(a" })).toMatchObject({
      facts: request.facts,
      goal: "(a",
    });
    expect(request).not.toHaveProperty("observe");
  });

  it("is complete, or says what is missing", () => {
    expect(missingIn(inputs)).toBeNull();
    expect(missingIn({ ...inputs, libraries: [] })).toMatch(/library/);
    expect(missingIn({ ...inputs, goal: " " })).toMatch(/goal/);
    expect(missingIn({ ...inputs, limit_s: Number.NaN })).toMatch(/limit/);
    const objects = [{ name: "c", type: "", value: "{" }];
    expect(missingIn({ ...inputs, objects })).toBe("The value of c is no JSON: change it.");
  });

  it("comes from files: a problem, or values of objects", () => {
    const world = withFile(inputs, '{"c": [1], "new": "here"}');
    expect(typeof world === "string" ? world : world.objects).toEqual([
      { name: "c", type: "cup", value: "[1]" },
      { name: "d", type: "", value: "" },
      { name: "new", type: "", value: '"here"' },
    ]);
    const text = "(define (problem p) (:objects c - mug) (:init (on c c)))";
    expect(withFile(inputs, text)).toMatchObject({
      name: "p",
      facts: "(on c c)",
      goal: "(a)\n(b)",
      objects: [{ name: "c", type: "mug", value: '{"x": 1}' }],
    });
    expect(withFile(inputs, "[1]")).toMatch(/neither/);
  });

  it("counts names of types without their case", () => {
    expect(wordsOf(null, { ...inputs, types: "Cup - Dish" }).types).toEqual({ cup: "dish" });
  });
});
