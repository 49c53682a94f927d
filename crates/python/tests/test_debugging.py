"""Breakpoints with conditions, and steps back through scripts, driven over the socket as a person would."""

import pathlib
import tempfile
import textwrap
import unittest

from support import Runner, container, save, script, sequence

STEP = """
def execute(self, inputs, outputs, gvm):
    print("+" + self.name, self.backward_execution)
    return 0

def backward_execute(self, inputs, outputs, gvm):
    print("-" + self.name, self.backward_execution)
"""


def execute(body, **state):
    """A state with this body of ``execute``."""
    head = "def execute(self, inputs, outputs, gvm):\n"
    return script(head + textwrap.indent(textwrap.dedent(body).strip("\n"), "    ") + "\n", **state)


def steps(*ids):
    return [script(STEP, id=id) for id in ids]


class Debugging(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def start(self, root, **launch):
        self.looked_at = 0
        return Runner(save(self.folder / "machine", root), **launch)

    def held(self, runner, path=None):
        """Reads until a branch is held (in this container) after the last command, and returns what is next there. That may have
        come before the command's answer."""
        while True:
            for message in runner.messages[self.looked_at :]:
                self.looked_at += 1
                event = message.get("event", {})
                if event.get("type") == "held" and path in (None, event["path"]):
                    return event["next"], event["by"]["type"]
            assert runner.read(lambda message: True), "the talk ended before a branch was held"

    def command(self, runner, name, **fields):
        """Gives a command and reads its answer."""
        self.looked_at = len(runner.messages)
        self.count = getattr(self, "count", 0) + 1
        sent = {"message": "command", "id": "c%d" % self.count, "command": {"type": name, **fields}}
        runner.send(sent)
        answer = runner.read(lambda m: m["message"] == "answer" and m["id"] == sent["id"])
        self.assertEqual(answer["answer"], "applied", answer)


class Conditions(Debugging):
    ports = {"inputs": [("n", "int", 0)], "outputs": [("m", "int", 0)]}

    def hits(self, condition, when="before"):
        """For a state that runs with n = 0, 1, 2 and gives m = 10 * n: for which n the breakpoint held."""
        count = 'outputs["m"] = 10 * inputs["n"]\ngvm.set_variable("g", inputs["n"])\nreturn 0'
        count = execute(count, id="A", **self.ports)
        after = execute('outputs["n"] = inputs["n"] + 1\nreturn 0 if inputs["n"] < 2 else 1', id="B",
                        inputs=[("n", "int", 0)], outputs=[("n", "int", 0)], outcomes=("again", "end"))  # fmt: skip
        flows = [(None, "s", "A", "n"), (None, "s", "B", "n"), ("B", "n", None, "s")]
        lines = [(None, None, "A"), ("A", 0, "B"), ("B", 0, "A"), ("B", 1, 0)]
        root = container("hierarchy", [count, after], lines, flows, scoped=[("s", "int", 0)])
        point = {"id": 1, "path": "R/A", "when": when, "condition": condition}
        runner = self.start(root, breakpoints=[point])
        found = []
        while runner.read_event(lambda event: event["type"] in ("hit", "finished"))["type"] == "hit":
            entered = [m for m in runner.messages if m["message"] == "event" and m["event"]["type"] == "entered"]
            runs = sum(m["event"]["path"] == "R/A" for m in entered)
            found.append(runs if when == "before" else runs - 1)
            self.held(runner)
            self.command(runner, "resume")
        result = runner.finish()
        self.assertEqual(result.outcome, "success", result.logged())
        return found, result.logged("engine")

    def test_inputs_scoped_and_global_variables(self):
        self.assertEqual(self.hits('inputs["n"] == 1'), ([1], []))
        self.assertEqual(self.hits('scoped["s"] > 0'), ([1, 2], []))
        self.assertEqual(self.hits('gvm.get("g") == 1 and "h" not in gvm'), ([2], []))

    def test_outputs_and_outcome_after_exit(self):
        self.assertEqual(self.hits('outputs["m"] == 10 and outcome == "success"', "after"), ([1], []))

    def test_the_data_of_the_run_stays_as_it_is(self):
        self.assertEqual(self.hits('inputs.get("n") == 2 and [inputs] != []'), ([2], []))
        found, lines = self.hits('inputs.update(n=7)')
        self.assertEqual(found, [0, 1, 2])
        self.assertIn("AttributeError", lines[0])

    def test_what_cannot_be_evaluated_holds_and_says_why(self):
        faults = {"1 +": "SyntaxError", 'inputs["x"]': "KeyError: 'x'", "1 / 0": "ZeroDivisionError"}
        for condition, why in faults.items():
            found, lines = self.hits(condition)
            self.assertEqual(found, [0, 1, 2])
            self.assertIn(why, lines[0])


class Backward(Debugging):
    def walk(self, root, commands, branches=1):
        """Steps through a held machine, back with so many branches at once; returns what scripts printed, step by step, up to
        the last command."""
        runner = self.start(root, hold=True)
        self.held(runner)
        for name in commands:
            self.command(runner, name)
            for _ in range(branches if name == "step_back" else 1):
                self.held(runner)
        self.command(runner, "resume")
        return runner.finish()

    def test_a_script_is_undone(self):
        result = self.walk(sequence(*steps("A", "B", "C")), ["step_over", "step_over", "step_back", "step_back"])
        forward, back = ["+a False", "+b False"], ["-b True", "-a True"]
        self.assertEqual(result.logged("stdout"), forward + back + ["+a False", "+b False", "+c False"])

    def test_through_a_hierarchy(self):
        inner = sequence(*steps("X", "Y"), id="I")
        root = sequence(*steps("A"), inner, *steps("B"))
        result = self.walk(root, ["step_over", "step_over", "step_back", "step_back", "step_back"])
        printed = ["+a False", "+x False", "+y False", "-y True", "-x True"]
        self.assertEqual(result.logged("stdout")[:5], printed)
        self.assertEqual(result.outcome, "success")

    def test_through_a_barrier(self):
        decider = script("def execute(self, i, o, g):\n    print('decided')\n    return 0\n", decider=True)
        barrier = container("barrier", steps("X", "Y") + [decider], [(decider["id"], 0, 0)], id="I")
        result = self.walk(sequence(barrier, *steps("B")), ["step_over", "step_back"], branches=2)
        printed = result.logged("stdout")
        self.assertEqual((sorted(printed[:2]), printed[2]), (["+x False", "+y False"], "decided"))
        self.assertEqual(sorted(printed[3:5]), ["-x True", "-y True"])
        self.assertEqual(result.outcome, "success")

    def test_the_data_is_what_it_was(self):
        add = """
def execute(self, inputs, outputs, gvm):
    outputs["n"] = inputs["n"] + 1
    print("+", inputs["n"])
    return 0

def backward_execute(self, inputs, outputs, gvm):
    outputs["n"] = 99
    print("-", inputs["n"])
"""
        ports = {"inputs": [("n", "int", 0)], "outputs": [("n", "int", 0)]}
        children = [script(add, id=id, **ports) for id in "ABC"]
        flows = [flow for id in "ABC" for flow in ((None, "s", id, "n"), (id, "n", None, "s"))]
        root = sequence(*children, flows=flows, scoped=[("s", "int", 0)])
        result = self.walk(root, ["step_over", "step_over", "step_back", "step_back"])
        # A script that is undone sees the data as they are after it ran.
        self.assertEqual(result.logged("stdout"), ["+ 0", "+ 1", "- 2", "- 1", "+ 0", "+ 1", "+ 2"])

    def test_a_script_without_it_and_one_that_fails(self):
        plain = execute("print('+p')\nreturn 0", id="P")
        fails = script(STEP.replace('    print("-" + self.name, self.backward_execution)', "    1 / 0"), id="F")
        result = self.walk(sequence(plain, fails, *steps("C")), ["step_over", "step_over", "step_back", "step_back"])
        self.assertEqual(result.logged("stdout"), ["+p", "+f False", "+p", "+f False", "+c False"])
        self.assertTrue(any("ZeroDivisionError" in line for line in result.logged(path="R/F")))
        self.assertEqual(result.outcome, "success")


ENGINE = "from rafcon.core.singleton import state_machine_execution_engine as engine\n"


class Scripts(Debugging):
    def test_a_script_may_step_its_machine(self):
        root = sequence(execute(ENGINE + "engine.step_mode()\nreturn 0", id="A"), *steps("B"))
        runner = self.start(root)
        self.assertEqual(self.held(runner), ("R/B", "step"))
        self.command(runner, "resume")
        result = runner.finish()
        told = [event["envelope"] for event in result.events if event["type"] == "commanded"]
        self.assertEqual([one["author"] for one in told][:1], ["script of R/A"])

    def test_a_command_that_cannot_be_carried_out_is_an_error_with_the_reason(self):
        root = sequence(execute(ENGINE + "engine.step_over()\nreturn 0", id="A"))
        result = self.start(root).finish()
        self.assertEqual(result.finished["outputs"]["error"]["__exc__"], "RuntimeError")

    def test_a_script_looks_back(self):
        look = """
            for item in self.execution_history:
                print(type(item).__name__, item.path, item.outcome and item.outcome.name)
            return 0
            """
        result = self.start(sequence(execute("return 0", id="A"), execute(look, id="B"))).finish()
        lines = ["CallItem R None", "CallItem R/A None", "ReturnItem R/A success", "CallItem R/B None"]
        self.assertEqual(result.logged("stdout"), lines)


if __name__ == "__main__":
    unittest.main()
