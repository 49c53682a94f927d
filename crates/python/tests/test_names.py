"""Names that programs, plugins and tests of old import: they are there, and do what they did."""

import os
import pathlib
import subprocess
import sys
import tempfile
import textwrap
import unittest

from building import PACKAGE, call
from support import run, save, script, sequence


def plain(program, **environment):
    """What a program prints that only imports the package."""
    ended = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(program)],
        capture_output=True,
        text=True,
        timeout=60,
        env={**os.environ, "PYTHONPATH": str(PACKAGE), **environment},
    )
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


class Imports(unittest.TestCase):
    def check(self, program, expected, **environment):
        self.assertEqual(plain(program, **environment), textwrap.dedent(expected).lstrip("\n"))

    def test_import_rafcon_reaches_every_module(self):
        self.check(
            """
            import rafcon
            for name in (
                "core.singleton.state_machine_manager", "core.storage.storage.load_state_machine_from_path",
                "core.state_machine.StateMachine", "core.execution.execution_engine.ExecutionEngine",
                "core.library_manager.LibraryManager", "core.states.hierarchy_state.HierarchyState",
                "core.states.library_state.LibraryState", "utils.constants.RAFCON_TEMP_PATH_BASE",
                "utils.multi_event.create", "design_patterns.observer.observable.Observable", "core.interface",
                "core.state_elements.data_port.InputDataPort", "dialog.ask",
            ):
                found = rafcon
                for part in name.split("."):
                    found = getattr(found, part)
            print("all")
            """,
            "all\n",
        )

    def test_it_costs_no_start_anything(self):
        self.check(
            """
            import sys, rafcon
            print(sorted(name for name in sys.modules if name.startswith("rafcon")))
            """,
            "['rafcon', 'rafcon._lazy']\n",
        )

    def test_a_name_that_is_not_there_is_an_attribute_error(self):
        self.check(
            """
            import rafcon
            print(hasattr(rafcon, "nothing"), hasattr(rafcon.core, "nothing"), hasattr(rafcon, "__path__"))
            try: from rafcon.utils import nothing
            except ImportError as error: print(error.name)
            """,
            "False False True\nrafcon.utils\n",
        )

    def test_a_script_reaches_the_engine_by_import_rafcon(self):
        text = (
            "import rafcon\n\n\ndef execute(self, inputs, outputs, gvm):\n"
            "    print(rafcon.core.singleton.state_machine_execution_engine.finished_or_stopped())\n    return 0\n"
        )
        with tempfile.TemporaryDirectory() as folder:
            result = run(save(pathlib.Path(folder, "m"), sequence(script(text))))
        self.assertEqual((result.outcome, result.logged("stdout")), ("success", ["False"]))


class Absent(unittest.TestCase):
    """Names that docs/differences.md says are not there."""

    def test_names_of_how_a_machine_is_run_are_not_there(self):
        found = call(
            """
            from rafcon.core.script import Script
            child = ExecutionState("child", "CHILDX")
            child.script_text = "def execute(self, inputs, outputs, gvm):\\n    return 0\\n"
            root = HierarchyState("root", "ROOTID")
            root.add_state(child)
            root.set_start_state(child)
            root.add_transition("CHILDX", 0, "ROOTID", 0)
            machine = StateMachine(root)
            storage.save_state_machine_to_path(machine, "libs/own")
            global_config.set_config_value("LIBRARY_PATHS", {"libs": "libs"})
            library_manager.initialize()
            machine.start()
            machine.join()
            items = list(machine.execution_histories[0])
            inside = ["id", "run", "start", "setup_run", "concurrency_queue", "thread"]
            places = [
                *((state, inside) for state in (root, child, BarrierConcurrencyState("both"), DeciderState("decider"))),
                (LibraryState("libs", "own"), [*inside, "lib_os_path"]),
                (Script(), ["execute", "compiled_module"]),
                (engine, ["run_to_states", "start_state_paths"]),
                *((item, ["prev", "next", "run_id", "scoped_data"]) for item in items),
            ]
            print(len(items), [(type(thing).__name__, name) for thing, names in places for name in names if hasattr(thing, name)])
            """
        )
        self.assertEqual(found, "4 []\n")


class Folders(unittest.TestCase):
    def test_the_temporary_folders_are_there_and_go_if_they_are_empty(self):
        with tempfile.TemporaryDirectory() as folder:
            program = """
            import os
            from rafcon.utils.constants import RAFCON_TEMP_PATH_BASE, RAFCON_TEMP_PATH_STORAGE
            from rafcon.core.constants import DEFAULT_SCRIPT_PATH
            print(os.path.isdir(RAFCON_TEMP_PATH_BASE))
            print(os.path.dirname(RAFCON_TEMP_PATH_STORAGE) == RAFCON_TEMP_PATH_BASE)
            print(DEFAULT_SCRIPT_PATH == RAFCON_TEMP_PATH_STORAGE, RAFCON_TEMP_PATH_BASE)
            """
            *truths, base = plain(program, TMPDIR=folder).split()
            self.assertEqual((truths, os.path.exists(base)), (["True"] * 3, False))
            *_truths, base = plain(
                textwrap.dedent(program) + "open(RAFCON_TEMP_PATH_BASE + '/kept', 'w')\n", TMPDIR=folder
            ).split()
            self.assertEqual(os.listdir(base), ["kept"])

    def test_a_script_writes_there(self):
        text = (
            "from rafcon.utils.constants import RAFCON_TEMP_PATH_BASE\n\n\ndef execute(self, inputs, outputs, gvm):\n"
            "    open(RAFCON_TEMP_PATH_BASE + '/f', 'w').close()\n    return 0\n"
        )
        with tempfile.TemporaryDirectory() as folder:
            result = run(save(pathlib.Path(folder, "m"), sequence(script(text))), env={"TMPDIR": folder})
        self.assertEqual(result.outcome, "success", result.logged())


class Interface(unittest.TestCase):
    """Questions on a terminal, answered by a function in the place of ``input``."""

    def check(self, calls, expected):
        program = """
        import os, tempfile
        from rafcon.core import interface
        here = tempfile.mkdtemp()
        new = os.path.join(here, "new")
        def ask(answer, function, *arguments):
            interface.input = lambda prompt: answer
            found = function(*arguments)
            print(None if found is None else os.path.relpath(found, here), end=" ")
        """
        self.assertEqual(plain(textwrap.dedent(program) + textwrap.dedent(calls)), expected)

    def test_a_folder_to_open(self):
        self.check(
            """
            open_folder = interface.open_folder_func
            ask(here, open_folder, "which")
            ask(here, open_folder, "which", "/")
            ask("", open_folder, "which", here)
            ask("", open_folder, "which")
            ask("", open_folder, "which", new)
            ask(new, open_folder, "which", here)
            """,
            ". . . None None None ",
        )

    def test_a_folder_to_create(self):
        self.check(
            """
            create = interface.create_folder_func
            ask(new, create, "which")
            print(os.path.isdir(new), end=" ")
            ask("", create, "which", "other", here)
            print(os.path.isdir(here + "/other"), end=" ")
            ask("", create, "which", "other")
            ask("", create, "which")
            ask("/proc/none/x", create, "which")
            """,
            "new True other True None None None ",
        )

    def test_a_folder_to_save_to(self):
        self.check(
            """
            save = interface.save_folder_func
            ask(new, save, "which")
            print(os.path.isdir(new), end=" ")
            ask("", save, "which", "other", here)
            ask("", save, "which", "other", new)
            ask("", save, "which")
            """,
            "new False other None None ",
        )

    def test_a_notice(self):
        self.check('ask("", interface.show_notice_func, "careful", ["ok"])', "None ")

    def test_a_program_silences_it(self):
        self.check(
            """
            interface.show_notice_func = lambda query: ""
            interface.open_folder_func = lambda query: None
            print(interface.show_notice_func(query="x") == "")
            """,
            "True\n",
        )


class Start(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def machine(self, ending="return 0"):
        text = f"def execute(self, inputs, outputs, gvm):\n    print('runs')\n    {ending}\n"
        return str(save(self.folder / "m", sequence(script(text, outcomes=("success", "other")))))

    def start(self, *arguments):
        """``python3 -m rafcon.core.start`` with these arguments: exit code and output."""
        program = f"""
        import runpy, sys
        sys.argv = ["start", *{arguments!r}]
        runpy.run_module("rafcon.core.start", run_name="__main__")
        """
        try:
            return 0, call(program)
        except AssertionError as error:
            return None, str(error)

    def test_the_module_runs_a_machine(self):
        code, said = self.start("-o", self.machine())
        self.assertEqual((code, said.splitlines()), (0, ["runs"]))

    def test_who_has_no_configuration_is_not_warned(self):
        program = f"""
        import logging, sys
        from rafcon.core import start
        logging.basicConfig(stream=sys.stdout, level=logging.WARNING)
        print(start.main(["-o", {self.machine()!r}]))
        """
        self.assertEqual(call(program).splitlines(), ["runs", "0"])

    def test_its_help_names_the_options(self):
        done = subprocess.run(
            [sys.executable, "-m", "rafcon.core.start", "--help"],
            capture_output=True,
            text=True,
            timeout=60,
            env={**os.environ, "PYTHONPATH": str(PACKAGE)},
        )
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for option in ("-o", "--open", "-c", "--config", "-r", "--remote", "-s", "--start_state_path"):
            self.assertRegex(done.stdout, rf"(?<![\w-]){option}(?![\w-])")

    def test_its_exit_code_is_that_of_the_run(self):
        program = """
        from rafcon.core import start
        print(start.main(["-o", %r]), start.main(["-o", %r, "-s", "R/NOTHING"]))
        """
        for ending, code in (("return 0", 0), ("1 / 0", 4), ("return -2", 5)):
            machine = self.machine(ending)
            lines = call(program % (machine, machine)).splitlines()
            self.assertEqual(lines[-1], f"{code} 1")

    def test_the_reactor_of_a_plugin_is_stopped_when_the_machine_has_ended(self):
        program = f"""
        import sys, threading, types
        from rafcon.core import start
        class Reactor:
            def __init__(self):
                self.stopped, self.running = threading.Event(), False
            def callWhenRunning(self, function):
                self.begin = function
            def run(self):
                self.running = True
                self.begin()
                self.stopped.wait()
            def callFromThread(self, function):
                function()
            def stop(self):
                print("stopped", engine.finished_or_stopped())
                self.running = False
                self.stopped.set()
        print(start.reactor_required())
        sys.modules["twisted"] = sys.modules["twisted.internet"] = twisted = types.ModuleType("twisted")
        twisted.reactor = Reactor()
        print(start.reactor_required(), start.main(["-o", {self.machine()!r}]))
        start.stop_reactor_on_state_machine_finish(state_machine_manager.state_machines[1])
        """
        self.assertEqual(call(program).splitlines(), ["False", "runs", "stopped True", "True 0"])

    def test_it_needs_a_machine_that_is_there(self):
        for arguments, reason in (
            ((), "no state machine is named; name one with -o"),
            (("-o", "/nowhere"), "there is no state machine in /nowhere"),
            (("-o", self.machine(), "-c", "/nowhere"), "there is no configuration /nowhere"),
        ):
            code, said = self.start(*arguments)
            self.assertIsNone(code)
            self.assertIn(reason, said)

    def test_a_program_takes_the_steps_itself(self):
        program = f"""
        import signal
        from rafcon.core import start
        from rafcon.core.singleton import argument_parser
        start.pre_setup_plugins()
        start.setup_environment()
        parser = start.setup_argument_parser()
        print(parser is argument_parser, start.setup_argument_parser() is parser, start.reactor_required())
        options = parser.parse_args(["-o", {self.machine()!r}, "-c", "None"])
        start.setup_configuration(options.config_path)
        start.post_setup_plugins(options)
        start.register_signal_handlers(start.signal_handler)
        machine = start.open_state_machine(start.parse_state_machine_path(options.state_machine_path[0]))
        start.start_state_machine(machine, options.start_state_path)
        start.wait_for_state_machine_finished(machine)
        start.signal_handler(signal.SIGINT)
        print(machine.root_state.final_outcome.name)
        """
        self.assertEqual(call(program).splitlines(), ["True True False", "runs", "success"])


if __name__ == "__main__":
    unittest.main()
