"""Scripts that do what they should not: each ends in its state's own *aborted* path, or in a clear last word."""

import fcntl
import os
import tempfile
import unittest

from support import Runner, container, run, save, script, sequence

DONE = "def execute(self, inputs, outputs, gvm):\n    return 0\n"


class BadScripts(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def run_one(self, text, show="repr", **options):
        """A machine that goes on by the outcome *aborted* of its first state."""
        show = f"def execute(self, inputs, outputs, gvm):\n    print({show}(inputs.get('error')))\n    return 0\n"
        root = container(
            "hierarchy",
            [script(text, "BAD"), script(show, "NEXT")],
            [(None, None, "BAD"), ("BAD", 0, 0), ("BAD", -1, "NEXT"), ("NEXT", 0, 0)],
        )
        return run(save(self.folder, root), **options)

    def check(self, text, error, said=""):
        result = self.run_one(text)
        self.assertEqual(result.logged("stdout", "R/NEXT"), [error], result.logged())
        self.assertIn(said, "\n".join(result.logged("engine", "R/BAD")))
        self.assertEqual((result.outcome, result.exit_code), ("success", 0))
        return result

    def test_it_raises(self):
        result = self.check("def execute(self, inputs, outputs, gvm):\n    raise ValueError('no')\n", "ValueError('no')")
        shown = "\n".join(result.logged("engine", "R/BAD"))
        self.assertIn("bad_BAD/script.py\", line 2, in execute", shown)
        self.assertIn("raise ValueError('no')", shown)

    def test_states_with_the_same_text_have_tracebacks_of_their_own(self):
        text = "def execute(self, inputs, outputs, gvm):\n    (lambda: 1 / 0)()\n"
        decider = script(DONE, decider=True)
        children = [script(text, "ONE"), script(text, "TWO"), decider]
        result = run(save(self.folder, container("barrier", children, [(decider["id"], 0, 0)])))
        self.assertEqual(result.outcome, "success")
        for name in ("one_ONE", "two_TWO"):
            shown = "\n".join(result.logged("engine", "R/" + name[-3:]))
            self.assertEqual(shown.count(name + "/script.py\", line 2"), 2, shown)

    def test_it_does_not_parse(self):
        result = self.run_one("def execute(self\n    return 0\n")
        self.assertTrue(result.logged("stdout", "R/NEXT")[0].startswith("SyntaxError("), result.logged())
        self.assertIn("bad_BAD/script.py", "\n".join(result.logged("engine", "R/BAD")))

    def test_the_text_of_its_error_names_file_and_line(self):
        result = self.run_one("def execute(self, inputs, outputs, gvm):\n    return 0 +\n", show="str")
        self.assertEqual(result.logged("stdout", "R/NEXT"), ["invalid syntax (script.py, line 2)"])

    def test_its_module_raises(self):
        self.check("import no_such_module\n" + DONE, "ModuleNotFoundError(\"No module named 'no_such_module'\")")

    def test_it_has_no_execute(self):
        self.check("x = 1\n", "AttributeError('the script has no function execute(self, inputs, outputs, gvm)')")

    def test_it_exits(self):
        self.check("import sys\ndef execute(*a):\n    sys.exit('enough')\n", "SystemExit('enough')", "SystemExit: enough")

    def test_a_forked_process_may_fork_again(self):
        text = """
import os
def ended(process):
    return os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
def execute(self, inputs, outputs, gvm):
    child = os.fork()
    if child == 0:
        grandchild = os.fork()
        os._exit(5 if grandchild == 0 else ended(grandchild))
    print(ended(child))
    return 0
"""
        result = self.run_one(text)
        self.assertEqual((result.logged("stdout"), result.printed["stderr"]), (["5"], ""))
        self.assertEqual((result.outcome, result.exit_code), ("success", 0))

    def test_it_raises_what_ends_programs(self):
        self.check("def execute(*a):\n    raise KeyboardInterrupt\n", "KeyboardInterrupt()")
        self.check("def execute(*a):\n    raise GeneratorExit\n", "GeneratorExit()")

    def test_it_returns_nonsense(self):
        self.check("def execute(*a):\n    return object\n", "None", "<class 'object'>")
        self.check("def execute(*a):\n    return 10 ** 30\n", "None", "1" + "0" * 30)
        self.check("def execute(*a):\n    return 99\n", "None", "99")

    def test_it_returns_what_cannot_be_compared(self):
        text = "class No:\n    __hash__ = None\ndef execute(*a):\n    return No()\n"
        self.check(text, "TypeError(\"unhashable type: 'No'\")")
        text = "class No:\n    def __repr__(self): raise OSError\ndef execute(*a):\n    return No()\n"
        self.check(text, "None", "something that cannot be shown")

    def test_it_is_a_coroutine(self):
        self.check("async def execute(*a):\n    return 0\n", "None", "run coroutines with `asyncio.run(…)` inside")

    def test_it_has_conflict_markers(self):
        result = self.run_one("<<<<<<< HEAD\nx = 1\n=======\nx = 2\n>>>>>>> other\n" + DONE, show="str")
        (said,) = result.logged("stdout", "R/NEXT")
        self.assertRegex(said, r"conflict markers of a merge: .* \(script.py, line 1\)")

    def test_an_exit_function_that_hangs_does_not_keep_the_process(self):
        result = self.run_one("import atexit, time\natexit.register(time.sleep, 1000)\n" + DONE)
        self.assertEqual((result.outcome, result.exit_code), ("success", 0))

    def test_it_recurses_without_end(self):
        result = self.run_one("def execute(*a):\n    return execute(*a)\n")
        self.assertIn("RecursionError", result.logged("stdout", "R/NEXT")[0])

    def test_it_has_no_file(self):
        self.check(None, "RuntimeError('the state has no script: add a script.py to its folder')")

    def test_it_prints_megabytes(self):
        text = "def execute(self, inputs, outputs, gvm):\n    for n in range(50):\n        print(str(n) * 50_000)\n    print('x' * 5_000_000)\n    return 0\n"
        result = self.run_one(text)
        lines = result.logged("stdout", "R/BAD")
        self.assertEqual(sum(map(len, lines)), sum(len(str(n)) * 50_000 for n in range(50)) + 5_000_000)
        self.assertEqual(result.outcome, "success")

    def test_of_a_long_return_value_the_beginning_is_shown(self):
        for value, shown in (
            ("'ä' * 200", "'" + "ä" * 200 + "'"),
            ("'ä' * 201", "'" + "ä" * 199),
            ("'ä' * 5000", "'" + "ä" * 199),
            ("('ä' * 195,)", "('" + "ä" * 195 + "',)"),
            ("('ä' * 196,)", "('" + "ä" * 196 + "',"),
        ):
            with self.subTest(value):
                result = self.check(f"def execute(*a):\n    return {value}\n", "None", shown)
                (said,) = result.logged("engine", "R/BAD")
                self.assertEqual(said.count("ä"), shown.count("ä"))

    def test_types_without_end_are_forgotten(self):
        text = """
import gc, sys, weakref
made = sys.modules.setdefault("made", weakref.WeakSet())
counts = sys.modules.setdefault("counts", [0])
def execute(self, inputs, outputs, gvm):
    counts[0] += 1
    outputs["v"] = (kind := type("Kind", (), {}))()
    made.add(kind)
    if counts[0] < 4200:
        return "again"
    del kind, outputs["v"]
    gc.collect()
    print(len(made))
    return "success"
"""
        root = sequence(script(text, outputs=[("v", "int", None)], outcomes=("success", "again")))
        root["transitions"].append(("A", 1, "A"))
        result = run(save(self.folder, root), keeping="off")
        (alive,) = result.logged("stdout")
        self.assertLess(int(alive), 1000)
        self.assertEqual(result.outcome, "success")

    def test_a_value_with_code_in_its_end_is_let_go(self):
        text = """
class Loud:
    def __init__(self, gvm): self.gvm = gvm
    def __deepcopy__(self, memo): return Loud(self.gvm)
    def __del__(self):
        self.gvm.set_variable("ends", self.gvm.get_variable("ends", default=0) + 1)
def execute(self, inputs, outputs, gvm):
    outputs["loud"] = Loud(gvm)
    return 0
"""
        loud = [("loud", "object", None)]
        take = "import gc\ndef execute(self, inputs, outputs, gvm):\n    del inputs['loud']\n    return 0\n"
        look = "def execute(self, inputs, outputs, gvm):\n    print(gvm.get_variable('ends') > 0)\n    return 0\n"
        root = sequence(
            sequence(script(text, outputs=loud), script(take, "B", inputs=loud), flows=[("A", "loud", "B", "loud")], id="IN"),
            script(look, "LOOK"),
        )
        result = run(save(self.folder, root))
        self.assertEqual(result.logged("stdout"), ["True"])

    def test_a_value_that_cannot_be_copied_is_passed_itself(self):
        text = "import threading\ndef execute(self, inputs, outputs, gvm):\n    outputs['x'] = threading.Lock()\n    self.parent.kept = outputs['x']\n    return 0\n"
        look = "def execute(self, inputs, outputs, gvm):\n    print(inputs['x'] is self.parent.kept)\n    return 0\n"
        port = [("x", "object", None)]
        root = sequence(
            script(text, outputs=port),
            script(look, "B", inputs=port),
            script(look, "C", inputs=port),
            flows=[("A", "x", "B", "x"), ("A", "x", "C", "x")],
        )
        result = run(save(self.folder, root))
        self.assertEqual(result.logged("stdout"), ["True", "True"])
        warned = [line for line in result.logged("engine") if "cannot be copied" in line]
        self.assertEqual(len(warned), 2)

    def test_outputs_without_a_port_are_reported(self):
        text = "def execute(self, inputs, outputs, gvm):\n    outputs['lost'] = 1\n    return 0\n"
        result = run(save(self.folder, sequence(script(text))))
        self.assertIn('the script set the output "lost", but the state has no such port', result.logged("engine")[0])


class LostProcesses(unittest.TestCase):
    def lose(self, text):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        runner = Runner(save(folder.name, sequence(script(DONE, "A"), script(text, "B"))))
        return runner.finish()

    def check(self, text, exit_code):
        result = self.lose(text)
        self.assertEqual((result.exit_code, result.finished), (exit_code, None))
        self.assertEqual(result.running_at_the_end(), ["R/B"])

    def test_it_ends_the_process(self):
        self.check("import os\ndef execute(*a):\n    os._exit(3)\n", 3)

    def test_it_crashes(self):
        self.check("import os, signal\ndef execute(*a):\n    os.kill(os.getpid(), signal.SIGKILL)\n", -9)
        self.check("import ctypes\ndef execute(*a):\n    ctypes.string_at(0)\n", -11)

    def test_a_forked_process_does_not_hold_the_talk_open(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        door = folder.name + "/door"
        os.mkfifo(door)
        text = """
import os
def execute(self, inputs, outputs, gvm):
    if os.fork() == 0:
        os.close(1)
        os.close(2)
        open(%r).read()
        os._exit(0)
    os._exit(3)
"""
        runner = Runner(save(folder.name + "/machine", sequence(script(text % door))))
        self.assertEqual(runner.finish().exit_code, 3)
        open(door, "w").close()

    def test_a_forked_process_does_not_hold_the_run(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        door, run_folder = folder.name + "/door", folder.name + "/run"
        os.mkfifo(door)
        text = """
import os
def execute(self, inputs, outputs, gvm):
    if os.fork() == 0:
        os.close(1)
        os.close(2)
        open(%r).read()
        os._exit(0)
    os._exit(3)
"""
        machine = save(folder.name + "/machine", sequence(script(text % door)))
        self.assertEqual(Runner(machine, run_folder=run_folder).finish().exit_code, 3)
        with open(run_folder + "/lock", "r+b") as lock:
            fcntl.lockf(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        open(door, "w").close()

    def test_nothing_is_marked_after_a_good_end(self):
        result = self.lose(DONE)
        self.assertEqual((result.outcome, result.running_at_the_end()), ("success", []))


class BadLaunches(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.machine = save(folder.name, sequence(script(DONE), inputs=[("n", "int", 0)]))

    def check(self, reason, machine=None, **launch):
        result = run(machine or self.machine, **launch)
        self.assertEqual([message["message"] for message in result.messages], ["load_failed"])
        self.assertIn(reason, result.messages[0]["reason"])
        self.assertEqual(result.exit_code, 1)

    def test_there_is_no_machine(self):
        self.check("/no/such/folder", machine="/no/such/folder")

    def test_there_is_no_such_state(self):
        self.check("there is no state at 'R/NO'", start_from="R/NO")

    def test_the_config_cannot_be_read(self):
        self.check("cannot read the config", config="/no/such/config.yaml")

    def test_inputs_reach_the_root(self):
        result = run(self.machine, inputs=[["n", 4]])
        self.assertEqual(result.outcome, "success")

    def test_there_is_no_such_input(self):
        self.check("the machine has no input `unknown`: it has `n`", inputs=[["n", 4], ["unknown", 1]])


if __name__ == "__main__":
    unittest.main()
