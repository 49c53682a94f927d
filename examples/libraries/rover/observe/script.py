"""Says what the simulated rover sees: the world at the beginning, and what has changed since."""

OBJECTS = "base ridge crater - Place battery - Battery mug - Mug"
BEGINNING = ("(rover-at base)", "(workshop base)", "(hand-empty)", "(at battery crater)", "(at mug ridge)")


def execute(self, inputs, outputs, gvm):
    changes = gvm.get_variable("rover_changes", default={})
    facts = {fact: True for fact in BEGINNING}
    facts.update(changes)
    seen = " ".join(fact for fact, holds in facts.items() if holds)
    outputs["facts"] = f"(define (problem seen) (:domain rover) (:objects {OBJECTS}) (:init {seen}))"
    return "success"
