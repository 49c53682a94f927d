import { expect, test } from "vitest";
import type { PddlWords } from "./pddl.ts";
import {
  faultsOfAction,
  filledIn,
  firstNotes,
  type SkillNotes,
  skillFaults,
  skillNotes,
  withoutSkillNotes,
  withSkillNotes,
  wordsOfNotes,
} from "./skill.ts";
import { sketch } from "./testing/sketch.ts";

const NOTHING: PddlWords = { signatures: [], objects: [], types: {} };

const PICK: SkillNotes = {
  pddl_action: `(:action pick :parameters (?thing - Cup ?place - Place)
    :precondition (and (at ?thing ?place) (not (= ?thing ?place)))
    :effect (and (not (at ?thing ?place)) (holding ?thing)))`,
  pddl_predicates: "(at ?thing - Thing ?place - Place) (holding ?thing - Thing)",
  pddl_functions: "",
  pddl_types: "Cup - Thing, Place",
  requirements: [":strips", ":typing"],
  description: "",
};

function state(ports: string) {
  const [found] = sketch(`R "Pick up it!" execution outcome ok ${ports}`).states;
  if (!found) throw new Error("no state");
  return found;
}

function wrongIn(pddl_action: string): readonly string[] {
  const notes = { ...PICK, pddl_action };
  return faultsOfAction(pddl_action, wordsOfNotes(notes, NOTHING)).map(({ message }) => message);
}

test("the annotation is read and written beside what else is there", () => {
  const data = withSkillNotes({ RAFCONTPP: { other: 1 }, mine: "x" }, PICK);
  expect(skillNotes(data)).toEqual(PICK);
  expect(withoutSkillNotes(data)).toEqual({ RAFCONTPP: { other: 1 }, mine: "x" });
  expect(withoutSkillNotes(withSkillNotes({ mine: "x" }, PICK))).toEqual({ mine: "x" });
  expect(skillNotes({ mine: "x" })).toBeNull();
  expect(skillNotes({ RAFCONTPP: { PDDL_ACTION: { pddl_action: 3 } } })?.pddl_action).toBe("");
});

test("an action that fits has no faults", () => {
  expect(wrongIn(PICK.pddl_action)).toEqual([]);
  expect(skillFaults(PICK, state("input thing:str input Place:str"))).toEqual([]);
  expect(filledIn(PICK)).toBeNull();
});

test("durative actions are checked without their times", () => {
  const action = `(:durative-action pick :parameters (?thing - Cup ?place - Place)
    :duration (= ?duration 3)
    :condition (and (at start (at ?thing ?place)) (over all (near ?place)))
    :effect (at end (holding ?thing)))`;
  expect(wrongIn(action)).toEqual(["No skill knows near. There is: at, holding."]);
});

test("what does not fit in an action is told", () => {
  expect(wrongIn("(:action a :parameters (?x - Cup) :effect (holding ?x ?x))")).toEqual([
    "holding takes 1 object, but has 2.",
  ]);
  expect(wrongIn("(:action a :parameters (?p - Place) :effect (holding ?p))")).toEqual([
    "?p is Place, and holding takes Thing here.",
  ]);
  expect(wrongIn("pick")).toEqual([
    "Write one action: (:action name :parameters (…) :precondition (…) :effect (…)).",
  ]);
  expect(wrongIn("(:action a :effect (and)) (:action b)")).toEqual([
    "A state has one action: remove this one.",
  ]);
});

test("parameters, types and predicates are compared with the ports and the words", () => {
  const notes = { ...PICK, pddl_predicates: "(at ?a - Thing ?b - Spot)", requirements: [":magic"] };
  expect(skillFaults(notes, state("input thing:str input speed:float"))).toEqual([
    "No input is called place: the state does not learn its value.",
    "No parameter sets the input speed: it keeps its default value.",
    "The type Spot is not among the types.",
    "The predicate holding is not among the predicates.",
    "The requirement :magic is not known.",
  ]);
});

test("predicates and types are filled in from the action", () => {
  expect(filledIn({ ...PICK, pddl_predicates: "", pddl_types: "" })).toEqual({
    pddl_predicates: "(at ?thing - Cup ?place - Place)\n(holding ?thing - Cup)",
    pddl_types: "Cup, Place",
  });
});

test("a first annotation has a parameter for each input", () => {
  const notes = firstNotes(state("input thing:str input place:str"));
  expect(notes.pddl_action).toBe(
    "(:action pick-up-it\n  :parameters (?thing ?place - object)\n  :precondition (and)\n  :effect (and))",
  );
  expect(faultsOfAction(notes.pddl_action, wordsOfNotes(notes, NOTHING))).toEqual([]);
  expect(firstNotes(state("")).pddl_action).toContain(":parameters ()");
});
