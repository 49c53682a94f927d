"""Plugins in real runs: what they say stands in the run's log, and whatever they do, the machine runs."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import textwrap
import unittest

from building import call
from support import BINARY, EXTENSION, STUCK_S, run, save, script, sequence

LEFT_OUT = ("the plugin /plugin0 is left out", "ModuleNotFoundError: No module named 'nothing_of_this_name'")
HELLO = "def execute(self, inputs, outputs, gvm):\n    print('runs')\n    return 0\n"

LOGS = """
from rafcon.utils import log
logger = log.get_logger("monitor")
def pre_init():
    logger.info("loaded")
def post_init(arguments):
    logger.warning("ready")
"""


class Plugins(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.machine = save(self.folder / "machine", sequence(script(HELLO)))

    def plugins(self, *texts):
        """The search path of plugins with these hooks."""
        folders = []
        for number, text in enumerate(texts):
            package = self.folder / f"plugin{number}"
            package.mkdir()
            (package / "__init__.py").write_text("")
            (package / "hooks.py").write_text(textwrap.dedent(text))
            folders.append(str(package))
        return os.pathsep.join(folders)

    def check(self, hooks, logged, **environment):
        """A machine runs to its end with a plugin, and these lines were logged."""
        result = run(self.machine, env={"RAFCON_PLUGIN_PATH": self.plugins(hooks), **environment})
        self.assertEqual((result.outcome, result.logged()), ("success", logged), result.printed)
        return result

    def test_what_it_logs_is_kept(self):
        self.check(LOGS, ["loaded", "ready", "runs"])

    def test_what_it_prints_is_kept(self):
        self.check(
            """
            import sys
            print("imported")
            def pre_init():
                print("one\\ntwo")
                print("wrong", file=sys.stderr)
            """,
            ["imported", "one\ntwo", "wrong", "runs"],
        )

    def test_of_what_it_prints_without_end_the_beginning_is_kept(self):
        hooks = """
            for number in range(16):
                print(str(number % 10) * 65536)
            print("no room")
            print("nor here")
            """
        kept = [str(number % 10) * 65536 for number in range(16)]
        self.check(hooks, [*kept, "2 further lines from before the start of the run are left out", "runs"])

    def test_one_that_fails_is_left_out(self):
        def left_out(first):
            self.setUp()
            path = self.plugins(first, LOGS)
            result = run(self.machine, env={"RAFCON_PLUGIN_PATH": path})
            self.assertEqual(result.outcome, "success", result.printed)
            said, *others = result.logged()
            self.assertEqual(others, ["loaded", "ready", "runs"])
            return said.replace(str(self.folder), "").splitlines()

        said = left_out("import nothing_of_this_name")
        self.assertEqual((said[0], said[-1]), LEFT_OUT)
        said = left_out("import sys; sys.exit('bye')")
        self.assertEqual((said[0], said[-1]), ("the plugin /plugin0 is left out", "SystemExit: bye"))
        said = left_out("def pre_init(): 1 / 0")
        self.assertEqual(said[0], "the hook pre_init of plugin0.hooks failed")

    def test_the_command_runs_a_machine_with_a_plugin_that_logs_prints_and_fails(self):
        path = self.plugins(LOGS, "print('printed')", "1 / 0")
        done = subprocess.run(
            [BINARY, "run", "--output", "json", str(self.machine)],
            capture_output=True,
            text=True,
            timeout=STUCK_S,
            env={
                **os.environ,
                "HOME": str(self.folder),
                "RAFCON_RUNS": str(self.folder / "runs"),
                "RAFCON_PYTHON": sys.executable,
                "RAFCON_EXTENSION": EXTENSION,
                "RAFCON_PLUGIN_PATH": path,
            },
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        events = map(json.loads, done.stdout.splitlines())
        lines = [event["message"].splitlines()[0] for event in events if event["type"] == "log"]
        left_out = f"the plugin {self.folder}/plugin2 is left out"
        self.assertEqual(lines, ["printed", left_out, "loaded", "ready", "runs"])

    def test_one_that_replaces_functions_of_the_engine_gets_advice(self):
        path = self.plugins(
            """
            from rafcon.core.script import Script
            def pre_init():
                before = Script.execute
            """
        )
        said, *others = run(self.machine, env={"RAFCON_PLUGIN_PATH": path}).logged()
        self.assertIn("the hooks `pre_script` and `post_script` are called around each script", said.splitlines()[0])
        self.assertEqual(others, ["runs"])

    def test_post_init_gets_the_arguments(self):
        hooks = """
        from rafcon.core.singleton import argument_parser
        def pre_init():
            argument_parser.add_argument("-nc", "--net_config_path")
        def post_init(arguments):
            print(arguments["net_config_path"], arguments["state_machine_path"], arguments["start_state_path"])
        """
        self.check(hooks, [f"None ['{self.machine}'] None", "runs"])

    def test_options_of_plugins_are_parsed(self):
        hooks = """
        from rafcon.core.singleton import argument_parser
        def pre_init():
            argument_parser.add_argument("-nc", "--net_config_path")
        def post_init(arguments):
            print(arguments["net_config_path"])
        """
        self.check(hooks, ["/a b", "runs"], RAFCON_PLUGIN_ARGUMENTS="-nc '/a b'")

    def test_options_that_nobody_knows_are_named(self):
        self.check(
            "def post_init(arguments): print(sorted(arguments))",
            [
                "cannot read RAFCON_PLUGIN_ARGUMENTS, so plugins get no options: "
                "unrecognized arguments: --no",
                "['start_state_path', 'state_machine_path']",
                "runs",
            ],
            RAFCON_PLUGIN_ARGUMENTS="--no",
        )

    def test_variables_in_the_path_are_expanded(self):
        self.plugins("print('loaded')")
        for path in ("$PLUGINS/plugin0", "${PLUGINS}/plugin0", "~/plugin0"):
            env = {"PLUGINS": str(self.folder), "HOME": str(self.folder), "RAFCON_PLUGIN_PATH": path}
            self.assertEqual(run(self.machine, env=env).logged(), ["loaded", "runs"])

    def test_hooks_that_are_never_called_are_named(self):
        hooks = """
        def main_window_setup(controller): pass
        def register_execution_history_consumer(manager): pass
        """
        path = self.plugins(hooks)
        lines = run(self.machine, env={"RAFCON_PLUGIN_PATH": path}).logged()
        self.assertEqual(
            [line.split(":")[0] for line in lines],
            [
                "the hook main_window_setup of plugin0 is never called",
                "the hook register_execution_history_consumer of plugin0 is never called",
                "runs",
            ],
        )

    def test_hooks_are_called_in_the_runs_of_a_program(self):
        path = self.plugins(
            """
            def pre_init(): print("pre_init")
            def post_init(arguments): print("post_init", arguments)
            def pre_script(): print("pre_script")
            def post_script(): print("post_script")
            def on_state_machine_execution_finished(): print("finished")
            """
        )
        program = f"""
        from rafcon.core import start
        start.pre_setup_plugins()
        start.post_setup_plugins(dict(own=1))
        start.start_state_machine(start.open_state_machine({str(self.machine)!r}))
        engine.join()
        """
        said = call(program, RAFCON_PLUGIN_PATH=path).splitlines()
        order = ["pre_init", "post_init {'own': 1}", "pre_script", "runs", "post_script", "finished"]
        self.assertEqual([line for line in said if line in order], order)

    def test_the_first_lines_are_the_first_of_the_journal(self):
        result = self.check("print('first')", ["first", "runs"])
        streams = [event["stream"] for event in result.events if event["type"] == "log"]
        self.assertEqual(streams, ["stdout", "stdout"])

    def test_without_a_run_it_is_printed(self):
        path = self.plugins(LOGS)
        result = run(self.folder / "nothing", env={"RAFCON_PLUGIN_PATH": path})
        self.assertEqual(result.outcome, None)
        self.assertEqual(result.printed["stderr"].splitlines()[:2], ["loaded", "ready"])


if __name__ == "__main__":
    unittest.main()
