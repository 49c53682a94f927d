import { expect, test } from "vitest";
import {
  faultsOf,
  goalOfText,
  offersAt,
  type PddlWords,
  problemOfText,
  textOfProblem,
  typesOfText,
} from "./pddl.ts";

const WORDS: PddlWords = {
  signatures: [
    { name: "at", arguments: [["robot"], ["place"]], isNumeric: false },
    { name: "holding", arguments: [["item"]], isNumeric: false },
    { name: "battery", arguments: [], isNumeric: true },
  ],
  objects: [
    { name: "rover", type: "robot" },
    { name: "dock", type: "place" },
    { name: "cup", type: "dish" },
    { name: "thing", type: "" },
  ],
  types: { dish: "item" },
};

function offered(before: string): string {
  const { typed, offers } = offersAt(before, WORDS);
  return `${typed}|${offers.map(({ label }) => label).join(" ")}`;
}

function wrong(text: string): readonly string[] {
  return faultsOf(text, WORDS).map(
    ({ from, to, message }) => `${text.slice(from, to)}: ${message}`,
  );
}

test("predicates are offered behind a bracket, and then objects of the type", () => {
  expect(offered("(")).toMatch(/^\|at holding battery and or not/);
  expect(offered("(and (hol")).toMatch(/^hol\|at holding/);
  expect(offered("(at ")).toBe("|rover thing");
  expect(offered("(at rover do")).toBe("do|dock thing");
  expect(offered("(holding ")).toBe("|cup thing");
  expect(offered("(at rover dock ")).toBe("|");
  expect(offered("(at rover dock) ")).toBe("|");
  expect(offered("; (at ")).toBe("|");
});

test("what cannot be is told at its place", () => {
  expect(wrong("(at rover dock)\n(not (holding cup))\n(= (battery) 3)")).toEqual([]);
  expect(wrong("(forall (?x - dish) (holding ?x))")).toEqual([]);
  expect(wrong("(near rover dock)")).toEqual([
    "near: No skill knows near. There is: at, holding, battery.",
  ]);
  expect(wrong("(at rover)")).toEqual(["(at rover): at takes 2 objects, but has 1."]);
  expect(wrong("(at dock rover)")).toEqual([
    "dock: dock is place, and at takes robot here.",
    "rover: rover is robot, and at takes place here.",
  ]);
  expect(wrong("(holding spoon)")).toEqual([
    "spoon: There is no object spoon: add it to the objects.",
  ]);
  expect(wrong("(and (holding cup)")).toEqual(["(: This bracket is not closed: add a )."]);
  expect(wrong("(holding cup))")).toEqual(["): This bracket closes nothing: remove it."]);
  expect(wrong("holding")).toEqual(["holding: Write a fact in parentheses: (on a b)."]);
  expect(wrong("()")).toEqual(["(): A fact begins with a predicate."]);
});

test("a problem is read and written", () => {
  const text = `; a world
    (define (problem Tea-time) (:domain x)
      (:objects rover - robot dock - place a b)
      (:init (at rover dock) (= (battery) 3))
      (:goal (and (holding cup))))`;
  const problem = problemOfText(text);
  expect(problem).toEqual({
    name: "Tea-time",
    objects: [
      { name: "rover", type: "robot" },
      { name: "dock", type: "place" },
      { name: "a", type: "" },
      { name: "b", type: "" },
    ],
    facts: "(at rover dock)\n(= (battery) 3)",
    goal: "(holding cup)",
  });
  if (problem) expect(problemOfText(textOfProblem(problem))).toEqual(problem);
  expect(problemOfText("(define")).toBeNull();
  expect(problemOfText("{}")).toBeNull();
  const named = textOfProblem({ name: "2 cups!", objects: [], facts: "", goal: "" });
  expect(named).toContain("(problem plan)");
});

test("several lines of a goal are all wanted", () => {
  expect(goalOfText("(a)\n(b)")).toBe("(and (a)\n(b))");
  expect(goalOfText(" (or (a) (b)) ")).toBe("(or (a) (b))");
  expect(goalOfText("")).toBe("(and )");
});

test("kinds of types are read as PDDL writes them", () => {
  expect(typesOfText("cup plate - dish\ndish - item loose")).toEqual({
    cup: "dish",
    plate: "dish",
    dish: "item",
  });
});
