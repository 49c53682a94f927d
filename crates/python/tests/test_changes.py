"""Scripts that change the machine that they are part of, while it runs."""

import pathlib
import tempfile
import unittest

from support import container, run, save, sequence
from test_scripts import execute

SAYS = "print(self.name, inputs)\nreturn 0"
BUILD = "from rafcon.core.states.execution_state import ExecutionState\n"


class Changes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def check(self, root, lines, outcome="success", error=None):
        result = run(save(self.folder / "machine", root))
        said = result.logged("logger")
        self.assertEqual(result.logged("stdout"), list(lines), said)
        self.assertEqual(result.outcome, outcome, said)
        found = result.finished["outputs"].get("error")
        self.assertEqual(found and found["__exc__"], error)
        return result

    def test_a_new_state_runs_next(self):
        body = BUILD + """
new = ExecutionState("new", "N")
new.note = "kept"
new.script_text = "def execute(self, inputs, outputs, gvm):\\n    print(self.name, self.note)\\n    return 0\\n"
ours = self.parent
ours.add_state(new)
print(ours.states["N"] is new, new.parent is ours, new.get_path(), sorted(ours.states))
line = ours.get_transition_for_outcome(self, self.outcomes[0])
line.to_state = "N"
ours.add_transition("N", 0, "B", None)
print(line, new.get_state_machine() is self.get_state_machine())
return 0
"""
        lines = [
            "True True R/N ['A', 'B', 'N']",
            "Transition - from_state: A, from_outcome: 0, to_state: N, to_outcome: None, id: 1 True",
            "new kept",
            "b {}",
        ]
        result = self.check(sequence(execute(body, id="A"), execute(SAYS, id="B")), lines)
        entered = [event["path"] for event in result.events if event["type"] == "entered"]
        self.assertEqual(entered, ["R", "R/A", "R/N", "R/B"])

    def test_a_whole_hierarchy_is_put_in(self):
        body = BUILD + """
from rafcon.core.states.hierarchy_state import HierarchyState
inner = HierarchyState("inner", "I")
leaf = ExecutionState("leaf", "L")
leaf.script_text = "def execute(self, inputs, outputs, gvm):\\n    print(self.get_path(), inputs)\\n    return 0\\n"
leaf.add_input_data_port("word", str, "inside")
inner.add_state(leaf)
inner.set_start_state(leaf)
inner.add_transition("L", 0, "I", 0)
self.parent.add_state(inner)
print(leaf.get_path(), leaf.parent is inner, inner.states["L"] is leaf)
leaf.input_data_ports[0].default_value = "changed"
self.parent.add_transition("I", 0, "R", 0)
self.parent.transitions[1].modify_target("I")
return 0
"""
        lines = ["R/I/L True True", "R/I/L {'word': 'changed'}"]
        self.check(sequence(execute(body, id="A")), lines)

    def test_a_copy_of_a_state_runs(self):
        body = """
from copy import copy
again = copy(self.parent.states["B"])
again.change_state_id("C")
again.name = "c"
self.parent.add_state(again)
self.parent.get_transition_for_outcome(self.parent.states["B"], again.outcomes[0]).to_state = "C"
self.parent.add_transition("C", 0, "R", 0)
return 0
"""
        lines = ["b {}", "c {}"]
        root = container("hierarchy", [execute(body, id="A"), execute(SAYS, id="B")], [
            (None, None, "A"), ("A", 0, "B"), ("B", 0, "A"),
        ])
        self.check(root, lines)

    def test_branches_change_one_machine(self):
        body = """
for _ in range(20):
    self.parent.add_scoped_variable(self.name + str(_), int, 1)
return 0
"""
        decide = "print(len(self.parent.scoped_variables))\nreturn 0"
        children = [execute(body, id="A"), execute(body, id="B"), execute(decide, decider=True)]
        decider = children[-1]["id"]
        lines = [("A", 0, decider), ("B", 0, decider), (decider, 0, 0)]
        self.check(container("barrier", children, lines), ["40"])

    def test_a_new_script_counts_at_the_next_entry(self):
        body = """
other = self.parent.states["B"]
other.script_text = "def execute(self, inputs, outputs, gvm):\\n    print('anew')\\n    return 0\\n"
self.script_text = "def execute(self, inputs, outputs, gvm):\\n    print('second')\\n    return 0\\n"
print(other.script_text.count("anew"), "still the old one")
return "again"
"""
        first = execute(body, id="A", outcomes=("success", "again"))
        transitions = [(None, None, "A"), ("A", 1, "A"), ("A", 0, "B"), ("B", 0, 0)]
        root = container("hierarchy", [first, execute(SAYS, id="B")], transitions)
        self.check(root, ["1 still the old one", "second", "anew"])

    def test_data_flows_and_variables_appear(self):
        body = """
ours, giver, taker = self.parent, self.parent.states["B"], self.parent.states["C"]
out = giver.add_output_data_port("word", str, "given")
port = taker.add_input_data_port("word", str, "default")
kept = ours.add_scoped_variable("kept", str, "old")
ours.add_data_flow("B", out, "C", port)
print(out, port, kept, [flow.to_state for flow in ours.data_flows.values()])
return 0
"""
        states = [execute(body, id="A"), execute("return 0", id="B"), execute(SAYS, id="C")]
        self.check(sequence(*states), ["0 0 0 ['C']", "c {'word': 'given'}"])

    def test_a_state_that_does_not_run_is_removed(self):
        body = """
gone = self.parent.remove_state("B")
print(gone.name, gone.parent, sorted(self.parent.states), len(self.parent.transitions))
self.parent.add_transition("A", 0, "R", 0)
return 0
"""
        self.check(sequence(execute(body, id="A"), execute(SAYS, id="B")), ["b None ['A'] 1"])

    def test_the_ground_is_not_pulled_away(self):
        body = """
from rafcon.core.custom_exceptions import MachineChangeRefused
try:
    self.parent.remove_state("A")
except MachineChangeRefused as refused:
    print(str(refused).count("R/A"), "A" in self.parent.states)
for change in (lambda: self.parent.remove_state("X"), lambda: self.add_outcome("success"),
               lambda: self.parent.add_transition("A", 0, "R", 0)):
    try:
        change()
    except Exception as error:
        print(type(error).__name__)
return 0
"""
        self.check(sequence(execute(body, id="A")), ["1 True", "AttributeError", "ValueError", "ValueError"])

    def test_what_runs_keeps_its_ports_and_outcomes(self):
        for change in ("self.add_outcome('new')", "self.parent.add_output_data_port('new', int)"):
            with self.subTest(change):
                self.setUp()
                self.check(sequence(execute(change, id="A")), [], outcome="aborted", error="MachineChangeRefused")

    def test_states_are_grouped_and_replaced(self):
        body = BUILD + """
ours = self.parent
group = ours.group_states(["B", "C"])
print(type(group).__name__, sorted(group.states), len(ours.states))
new = ExecutionState("new", "N")
new.script_text = "def execute(self, inputs, outputs, gvm):\\n    print('new')\\n    return 0\\n"
ours.substitute_state("D", new)
print(sorted(key for key in ours.states if len(key) == 1), new.get_path())
return 0
"""
        states = [execute(body, id="A"), *(execute(SAYS, id=key) for key in "BCD")]
        lines = ["HierarchyState ['B', 'C'] 3", "['A', 'N'] R/N", "b {}", "c {}", "new"]
        self.check(sequence(*states), lines)

    def test_a_barrier_grows_for_its_next_entry(self):
        grow = BUILD + """
barrier = self.parent.states["P"]
new = ExecutionState("new", "N")
new.script_text = "def execute(self, inputs, outputs, gvm):\\n    gvm.set_variable('new', 1)\\n    return 0\\n"
barrier.add_state(new)
return 0
"""
        decide = "print(sorted(self.final_outcomes_dict), gvm.get_variable('new'))\nreturn 0"
        children = [execute("return 0", id="C"), execute(decide, decider=True)]
        decider = children[-1]["id"]
        inner = container("barrier", children, [("C", 0, decider), (decider, 0, 0)], id="P")
        self.check(sequence(execute(grow, id="A"), inner), ["['C', 'N'] 1"])


if __name__ == "__main__":
    unittest.main()
