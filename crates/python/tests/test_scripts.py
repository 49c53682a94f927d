"""What scripts see in a real run: the package and the extension together."""

import pathlib
import tempfile
import textwrap
import unittest

from support import container, run, save, script, sequence


def execute(body, **state):
    """A state with this body of ``execute``."""
    head = "def execute(self, inputs, outputs, gvm):\n"
    return script(head + textwrap.indent(textwrap.dedent(body).strip("\n"), "    ") + "\n", **state)


class Scripts(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_machine(self, root, **options):
        return run(save(self.folder / "machine", root), **options)

    def check(self, body, *before, lines=(), outcome="success", error=None, **state):
        """Runs a state, after others, and compares what it printed, how the machine ended and with which error."""
        result = self.run_machine(sequence(*before, execute(body, **{"id": "X", **state})))
        self.assertEqual(result.logged("stdout", "R/X"), list(lines), result.logged("logger"))
        self.assertEqual(result.outcome, outcome, result.logged("logger"))
        found = result.finished["outputs"].get("error")
        self.assertEqual(found and found["__exc__"], error)
        return result

    def test_who_it_is(self):
        self.check(
            """
            machine = self.get_state_machine()
            print(self.name, self.state_id, self.get_path(), self.get_path(by_name=True), type(self).__name__)
            print(self.parent.state_id, self.parent.parent is machine, machine.root_state is self.parent)
            print(self.parent.states["X"] is self, machine.get_state_by_path("R/X") is self, self.is_root_state)
            print(self.file_system_path == machine.file_system_path + "/x_X", self.description)
            print(sorted(o.name for o in self.outcomes.values()), self.logger.name, self.run_id is not None)
            print(type(self.parent).__name__, self.parent.start_state_id, self.script_text.startswith("def execute"))
            return "success"
            """,
            lines=[
                "x X R/X r/x ExecutionState",
                "R True True",
                "True True False",
                "True None",
                "['aborted', 'preempted', 'success'] rafcon.x True",
                "HierarchyState X True",
            ],
        )

    def test_ports_and_data(self):
        self.check(
            """
            (port,) = self.input_data_ports.values()
            print(port.name, port.data_type is int, port.default_value, inputs)
            outputs["b"] = inputs["a"] + 1
            print(self.input_data, self.output_data)
            return 0
            """,
            inputs=[("a", "int", 3)],
            outputs=[("b", "int", None)],
            lines=["a True 3 {'a': 3}", "{'a': 3} {'b': 4}"],
        )

    def test_a_value_of_a_wrong_type_is_logged_once_for_each_port_that_it_reaches(self):
        number = [("x", "int", 0)]
        after = execute("return 0", id="IN", inputs=number)
        root = sequence(
            execute("outputs['x'] = 'text'\nreturn 0", id="A", outputs=number),
            sequence(after, id="B", inputs=number, flows=[(None, "x", "IN", "x")]),
            execute("return 0", id="C", inputs=[("x", "object", None)]),
            scoped=[("kept", "float", 0.0)],
            outputs=[("given", "int", 0)],
            flows=[("A", "x", to, port) for to, port in (("B", "x"), ("C", "x"), (None, "kept"), (None, "given"))],
        )
        logged = [
            (event["path"], event["level"], event["message"].partition(";")[0])
            for event in self.run_machine(root).events
            if event["type"] == "log"
        ]
        ports = [("R/A", "x", "int"), ("R", "kept", "float"), ("R/B", "x", "int"), ("R/B/IN", "x", "int"), ("R", "given", "int")]
        self.assertEqual(
            logged,
            [(path, "error", f'"{port}" got a value of type str but declares {kind}') for path, port, kind in ports],
        )

    def test_what_is_kept_from_run_to_run(self):
        counts = execute(
            """
            n = self.persistent_variables.get("n", 0) + 1
            self.persistent_variables["n"] = self.anything = n
            print(n, self.anything)
            return "again" if n < 3 else "success"
            """,
            outcomes=("success", "again"),
        )
        loop = container("hierarchy", [counts], [(None, None, "A"), ("A", 1, "A"), ("A", 0, 0)])
        self.assertEqual(self.run_machine(loop).logged("stdout"), ["1 1", "2 2", "3 3"])

    def test_what_ran_before(self):
        self.check(
            """
            before = self.get_previously_executed_state()
            print(before.state_id, before.final_outcome.name, before.output_data)
            return 0
            """,
            execute("return 'success'"),
            lines=["A success {}"],
        )

    def test_scoped_variables_of_the_container(self):
        text = "data = self.parent.scoped_data['200R']\nprint(data.value, data.from_state)\nreturn 0"
        root = sequence(execute(text), scoped=[("n", "int", 5)])
        self.assertEqual(self.run_machine(root).logged("stdout"), ["5 R"])

    def test_values_of_a_thread_last_as_long_as_its_branch(self):
        text = """
            import sys, threading
            here = sys.__dict__.setdefault("_here", threading.local())
            print(vars(here))
            here.seen = self.state_id
            return 0
        """
        root = sequence(execute(text, id="A"), execute(text, id="B"))
        self.assertEqual(self.run_machine(root).logged("stdout"), ["{}", "{'seen': 'A'}"])

    def test_an_error_in_the_outputs_reaches_the_next_state(self):
        fails = execute("outputs['error'] = 'why'\nreturn 'aborted'", id="A")
        handles = execute("print(inputs)\nreturn 0", id="B")
        root = container("hierarchy", [fails, handles], [(None, None, "A"), ("A", -1, "B"), ("B", 0, 0)])
        self.assertEqual(self.run_machine(root).logged("stdout"), ["{'error': 'why'}"])

    def test_a_dollar_alone_is_a_text(self):
        self.check("print(inputs)\nreturn 0", inputs=[("a", "str", "$")], lines=["{'a': '$'}"])

    def test_a_script_in_another_encoding_runs(self):
        machine = save(self.folder / "machine", sequence(execute("return 0", id="X")))
        (script,) = machine.glob("*/script.py")
        body = "def execute(self, inputs, outputs, gvm):\n    print(ascii('\u00e9'))\n    return 0\n"
        script.write_bytes(body.encode("utf-8-sig"))
        self.assertEqual(run(machine).logged("stdout"), ["'\\xe9'"])
        script.write_bytes(("# -*- coding: latin-1 -*-\n" + body).encode("latin-1"))
        self.assertEqual(run(machine).logged("stdout"), ["'\\xe9'"])

    def test_a_decider_sees_the_others(self):
        children = [
            execute("return 'success'", id="A"),
            execute("raise ValueError('no')", id="B"),
            execute(
                """
                print(self.get_outcome_for_state_name("a").name, self.get_outcome_for_state_id("B").outcome_id)
                print(repr(self.get_errors_for_state_name("b")), self.get_errors_for_state_name("a"))
                print(sorted(self.final_outcomes_dict), sorted(self.child_errors))
                return 0
                """,
                decider=True,
            ),
        ]
        decider = children[-1]["id"]
        transitions = [("A", 0, decider), ("B", 0, decider), (decider, 0, 0)]
        result = self.run_machine(container("barrier", children, transitions))
        lines = ["success -1", "ValueError('no') None", "['A', 'B'] ['B']"]
        self.assertEqual((result.outcome, result.logged("stdout")), ("success", lines))

    def first_of_two(self, loser, winner="gvm.get_variable('loser is there'); return 0"):
        """What two children do of which the second wins once the first is there."""
        there = "gvm.set_variable('n', 0)\nkey = gvm.lock_variable('n')\ngvm.set_variable('key', key)\nreturn 0"
        both = container(
            "preemptive",
            [execute(loser, id="A"), execute(winner, id="B")],
            [("A", 0, 0), ("B", 0, 0)],
            id="P",
        )
        return self.run_machine(sequence(execute(there, id="L"), both))

    def test_waits_end_by_preemption(self):
        result = self.first_of_two(
            """
            gvm.unlock_variable("n", gvm.get_variable("key"))
            print(self.preemptive_wait(), self.preempted, self.wait_for_interruption(1e9), self._preempted.wait())
            return 0
            """,
            "gvm.get_variable('n')\nprint(self.preempted, self.preemptive_wait(0))\nreturn 0",
        )
        self.assertEqual(result.logged("stdout", "R/P/A"), ["True True True True"])
        self.assertEqual(result.logged("stdout", "R/P/B"), ["False False"])
        self.assertIn("-R/P/A=preempted", result.steps())
        self.assertEqual(result.outcome, "success")

    def test_a_wait_for_a_locked_variable_ends_by_preemption(self):
        result = self.first_of_two(
            """
            try:
                gvm.get_variable("n")
            except Exception:
                print("never")
            finally:
                print("cleaned up")
            """,
            "return 0",
        )
        self.assertEqual(result.logged("stdout"), ["cleaned up"])
        self.assertIn("-R/P/A=preempted", result.steps())
        self.assertEqual(result.outcome, "success")
        self.assertNotIn("error", result.finished["outputs"])

    def test_branches_count_together(self):
        count = """
            for _ in range(50):
                key = gvm.lock_variable("n", block=True)
                gvm.set_locked_variable("n", key, gvm.get_locked_variable("n", key) + 1)
                gvm.unlock_variable("n", key)
            return 0
            """
        names = ["A", "B", "C", "D"]
        decider = execute("print(gvm.get_variable('n'))\nreturn 0", decider=True)
        children = [execute(count, id=name) for name in names] + [decider]
        transitions = [(name, 0, decider["id"]) for name in names] + [(decider["id"], 0, 0)]
        barrier = container("barrier", children, transitions, id="P")
        result = self.run_machine(sequence(execute("gvm.set_variable('n', 0)\nreturn 0", id="I"), barrier))
        self.assertEqual(result.logged("stdout"), ["200"])
        self.assertEqual(result.finished["globals"], {"n": 200})

    def test_stop_from_a_script(self):
        self.check(
            """
            from rafcon.core.singleton import state_machine_execution_engine as engine
            print(engine.status.execution_mode.name, engine.finished_or_stopped())
            engine.stop()
            print(self.preemptive_wait(), engine.finished_or_stopped())
            return "success"
            """,
            lines=["STARTED False", "True True"],
            outcome="preempted",
        )

    def test_pause_and_resume_from_scripts(self):
        self.check(
            """
            from rafcon.core.singleton import state_machine_execution_engine as engine
            engine.pause()
            print(self.wait_for_interruption(), self.paused, engine.status.execution_mode.name)
            engine.start()
            print(self.wait_for_unpause(), self.started, self.paused)
            return 0
            """,
            lines=["True True PAUSED", "True True False"],
        )

    def test_the_configuration_in_force(self):
        machine = save(self.folder / "machine", sequence(execute(
            """
            from rafcon.core.config import global_config
            from rafcon.core.singleton import library_manager
            print(global_config.get_config_value("SCRIPT_RECOMPILATION_ON_STATE_EXECUTION"))
            print(library_manager.libraries["own"] == {"arm": library_manager.library_root_paths["own"] + "/arm"})
            return 0
            """
        )))  # fmt: skip
        save(self.folder / "own" / "arm", sequence(execute("return 0")))
        result = run(machine, libraries=[("own", str(self.folder / "own"))])
        self.assertEqual(result.logged("stdout"), ["True", "True"])

    def test_the_desktop_is_missing_as_it_always_was(self):
        self.check("from rafcon.gui.config import X", outcome="aborted", error="ModuleNotFoundError")
        self.check("import gi", outcome="aborted", error="ModuleNotFoundError")

    def test_output_of_every_kind(self):
        result = self.check(
            """
            import logging, sys, threading, warnings
            print("one", end=" ")
            print("line")
            sys.stderr.write("to stderr\\n")
            self.logger.verbose("quiet")
            logging.getLogger("elsewhere").warning("from elsewhere")
            for target, text in ((print, "from a thread"), (self.logger.info, "logged by a thread")):
                thread = threading.Thread(target=target, args=(text,))
                thread.start()
                thread.join()
            sys.stdout.write("unfinished")
            return 0
            """,
            lines=["one line", "unfinished"],
        )
        self.assertEqual(result.logged("stderr", "R/X"), ["to stderr"])
        self.assertEqual(result.logged("logger", "R/X"), ["quiet", "elsewhere: from elsewhere", "logged by a thread"])
        self.assertEqual(result.logged("stdout"), ["one line", "from a thread", "unfinished"])

    def test_a_library_that_logs_at_debug_leaves_nothing_to_acknowledge(self):
        result = self.check(
            """
            import logging, sys
            logging.basicConfig(level=logging.DEBUG)
            driver = logging.getLogger("robot.driver")
            driver.debug("connect")
            driver.info("connected")
            print("INFO by itself", file=sys.stderr)
            print("working", end="", flush=True)
            for done in range(3):
                print(f"\\r{done + 1} of 3", end="", file=sys.stderr, flush=True)
            return 0
            """,
            lines=["working"],
        )
        logs = [event for event in result.events if event["type"] == "log"]
        self.assertEqual(
            [(event["level"], event["stream"], event["path"], event["message"]) for event in logs],
            [
                ("debug", "logger", "R/X", "robot.driver: connect"),
                ("info", "logger", "R/X", "robot.driver: connected"),
                ("info", "stderr", "R/X", "INFO by itself"),
                ("info", "stdout", "R/X", "working"),
                ("info", "stderr", "R/X", "3 of 3"),
            ],
        )

    def test_where_nobody_types_the_error_says_what_to_do(self):
        advice = "rafcon.dialog.text"
        result = self.check("input()", outcome="aborted", error="EOFError")
        self.assertIn(advice, result.finished["outputs"]["error"]["msg"])
        for stop in ("breakpoint()", "import pdb; pdb.set_trace()"):
            error = self.run_machine(sequence(execute(f"{stop}\nn = 1"))).finished["outputs"]["error"]
            self.assertEqual(error["__exc__"], "RuntimeError")
            self.assertIn("python3 -m rafcon.core.start", error["msg"])

    def test_a_script_may_fork(self):
        result = self.check(
            """
            import multiprocessing, os, sys
            child = os.fork()
            if child == 0:
                print("from the child", flush=True)
                gvm.set_variable("n", self.name)
                os._exit(7)
            print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
            with multiprocessing.get_context("fork").Pool(2) as pool:
                print(pool.map(abs, [-1, -2]))
            return 0
            """,
            lines=["7", "[1, 2]"],
        )
        self.assertEqual(result.printed["stdout"], "from the child\n")
        self.assertEqual(result.finished["globals"], {})

    def test_a_process_of_multiprocessing_ends_as_its_work_does(self):
        self.check(
            """
            import multiprocessing, os, sys, threading
            go, done = os.pipe(), os.pipe()

            def start():
                threading.Thread(target=lambda: os.write(done[1], os.read(go[0], 9))).start()

            def run(target, *args):
                child = multiprocessing.get_context("fork").Process(target=target, args=args)
                child.start()
                child.join()
                return child.exitcode

            print(run(abs, 1), run(sys.exit, 5), run(sys.exit, "bad"), run(int, "x"))
            os.write(go[1], b"joined")
            print(run(start), os.read(done[0], 9))
            return 0
            """,
            lines=["0 5 1 1", "0 b'joined'"],
        )

    def test_a_forked_copy_of_the_script_ends_as_a_program_does(self):
        self.check(
            """
            import os, sys, threading
            go, done = os.pipe(), os.pipe()

            def ended(child):
                return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])

            child = os.fork()
            if child == 0:
                threading.Thread(target=lambda: os.write(done[1], os.read(go[0], 9))).start()
                return 0
            os.write(go[1], b"joined")
            print(ended(child), os.read(done[0], 6))
            for code in (5, None, "bad"):
                child = os.fork()
                if child == 0:
                    sys.exit(code)
                print(ended(child))
            return 0
            """,
            lines=["0 b'joined'", "5", "0", "1"],
        )

    def test_a_child_dies_of_signals_that_are_not_for_the_run(self):
        self.check(
            """
            import multiprocessing, os, signal
            for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
                child = multiprocessing.get_context("fork").Process(target=signal.pause)
                child.start()
                os.kill(child.pid, number)
                child.join()
                print(child.exitcode == -number, self.preempted)
            return 0
            """,
            lines=["True False"] * 3,
        )

    def test_the_traceback_is_the_users(self):
        result = self.check("import json\njson.loads('{')", outcome="aborted", error="JSONDecodeError")
        (shown,) = [line for line in result.logged("engine", "R/X") if "Traceback" in line]
        self.assertRegex(shown, r'Traceback \(most recent call last\):\n  File ".*/x_X/script.py", line 3, in execute')
        self.assertNotIn("_native", shown)

    def test_plugins_are_called_around_scripts(self):
        plugin = self.folder / "plugin"
        plugin.mkdir()
        (plugin / "__init__.py").write_text("")
        (plugin / "hooks.py").write_text(
            "def pre_script(): print('before')\n"
            "def post_script(): print('after')\n"
            "def on_state_machine_execution_finished(): print('finished')\n"
        )
        machine = save(self.folder / "machine", sequence(execute("print('script')\nreturn 0", id="X")))
        result = run(machine, env={"RAFCON_PLUGIN_PATH": str(plugin)})
        self.assertEqual(result.logged("stdout"), ["before", "script", "after", "finished"])


if __name__ == "__main__":
    unittest.main()
