"""The package as a whole: it imports everywhere, everything public is described, and the list of files is right."""

import ast
import importlib
import importlib.util
import inspect
import os
import pathlib
import pkgutil
import subprocess
import sys
import tempfile
import unittest

import stage
from support import BOOTSTRAP, EXTENSION
import rafcon


def files():
    return sorted(path.relative_to(stage.PACKAGE).as_posix() for path in stage.PACKAGE.glob("rafcon/**/*.py"))


def plain(program, **environment):
    """Runs a program in an interpreter without a machine."""
    return subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        timeout=60,
        env={**os.environ, "PYTHONPATH": str(stage.PACKAGE), **environment},
    )


WITHOUT_A_MACHINE = """
import rafcon._runtime, rafcon.core.singleton as s
print(s.state_machine_manager.state_machines, s.state_machine_execution_engine.finished_or_stopped())
s.global_variable_manager.set_variable('a', 1)
s.state_machine_execution_engine.pause()
"""


#: Packages of an installation of ROS 2.
ROS = ("rclpy", "action_msgs")


class Package(unittest.TestCase):
    def test_every_module_is_imported(self):
        for module in pkgutil.walk_packages(rafcon.__path__, "rafcon."):
            try:
                importlib.import_module(module.name)
            except ModuleNotFoundError as error:
                missing, package = error.name.split(".")[0], module.name.rpartition(".")[0]
                self.assertIn((missing, package), {(name, each) for name in ROS for each in ("rafcon.utils.ros2", "rafcon.ros")})

    def test_the_list_of_files_is_right(self):
        self.assertEqual((stage.PACKAGE / "MANIFEST").read_text().splitlines(), files())

    def test_everything_public_is_described(self):
        for file in files():
            tree = ast.parse((stage.PACKAGE / file).read_text(encoding="utf-8"))
            self.assertTrue(ast.get_docstring(tree), file)
            for node in undescribed(tree):
                self.fail("%s:%d: `%s` has no docstring" % (file, node.lineno, node.name))

    def test_decorated_methods_show_their_own_parameters(self):
        shown, written = {}, {}
        for file in files():
            for cls, method in decorated(ast.parse((stage.PACKAGE / file).read_text(encoding="utf-8"))):
                module = importlib.import_module(file[: -len(".py")].replace("/", "."))
                found = getattr(getattr(module, cls.name), method.name)
                place = f"{file} {cls.name}.{method.name}"
                shown[place] = found.__name__, list(inspect.signature(found).parameters)
                written[place] = method.name, [word.arg for word in method.args.args]
        self.assertEqual(shown, written)
        self.assertIn("rafcon/core/states/_changes.py StateChanges.add_outcome", shown)
        self.assertIn("rafcon/core/execution/execution_engine.py ExecutionEngine.start", shown)

    def test_the_version_is_that_of_the_workspace(self):
        workspace = (stage.PACKAGE.parents[2] / "Cargo.toml").read_text()
        self.assertIn(f'version = "{rafcon.__version__}"', workspace)

    def test_without_a_machine_it_says_so(self):
        done = plain(WITHOUT_A_MACHINE)
        self.assertEqual(done.stdout, "{} True\n")
        self.assertIn("start the machine with `rafcon run PATH`", done.stderr.splitlines()[-1])

    def test_the_compiled_module_without_a_machine_says_so_too(self):
        load = BOOTSTRAP.rpartition("sys.exit")[0] % EXTENSION
        done = plain(load + WITHOUT_A_MACHINE)
        self.assertEqual(done.stdout, "{} True\n", done.stderr)
        self.assertIn("no state machine runs in this process", done.stderr.splitlines()[-1])

    def test_the_desktop_is_missing_as_it_always_was(self):
        done = plain(
            "import rafcon.gui.utils\n"
            "from rafcon.gui.utils import wait_for_gui\n"
            "for name in ('rafcon.gui.singleton', 'rafcon.gui.utils.dialog', 'rafcon.gui.config'):\n"
            "    try: __import__(name)\n"
            "    except ModuleNotFoundError as error: print(error)\n",
        )
        self.assertEqual(done.stdout, "No module named 'gi'\n" * 3, done.stderr)

    def test_modules_of_the_desktop_and_of_other_histories_are_not_there(self):
        histories = ("consumer_manager", "consumers", "execution_history_factory")
        names = ["core.execution." + name for name in histories] + ["design_patterns.mvc"]
        names += ["utils." + name for name in ("installation", "profiler", "profiling", "threads")]
        self.assertEqual([name for name in names if importlib.util.find_spec("rafcon." + name)], [])


WRAPPING = [ast.dump(ast.parse(name).body[0].value) for name in ("lock_state_machine", "Observable.observed")]


def undescribed(tree):
    """Public classes, functions and methods without a docstring; what overrides a standard class needs none."""
    classes = [node for node in tree.body if isinstance(node, ast.ClassDef) and not node.name.startswith("_")]
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    methods = [node for cls in classes for node in cls.body if isinstance(node, ast.FunctionDef) and not setter(node)]
    named = [node for node in classes + functions + methods if not node.name.startswith("_")]
    return [node for node in named if not ast.get_docstring(node)]


def decorated(tree):
    """Public methods whose calls go through another function, each behind its class."""
    for cls in (node for node in tree.body if isinstance(node, ast.ClassDef)):
        for node in cls.body:
            if isinstance(node, ast.FunctionDef) and not node.name.startswith("_") and len(node.decorator_list) == 1:
                if ast.dump(node.decorator_list[0]) in WRAPPING:
                    yield cls, node


def setter(function):
    return any(isinstance(decorator, ast.Attribute) for decorator in function.decorator_list)


PLUGIN = """
def post_init(arguments):
    print("init", arguments["start_state_path"], arguments["state_machine_path"])
def pre_script():
    print("before")
def post_script():
    print("after")
"""


class Plugins(unittest.TestCase):
    def test_hooks_are_called_and_broken_plugins_left_out(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in (("good_plugin", PLUGIN), ("bad_plugin", "1 / 0")):
                package = pathlib.Path(folder) / name
                package.mkdir()
                (package / "__init__.py").write_text("")
                (package / "hooks.py").write_text(text)
            path = os.pathsep.join([os.path.join(folder, "bad_plugin"), os.path.join(folder, "good_plugin")])
            done = plain(
                "from rafcon._runtime import hooks\n"
                "hooks.load()\n"
                "hooks.begin('/m', None, 'A')\n"
                "print(hooks.active)\n"
                "hooks.pre_script(); hooks.post_script(); hooks.finished(); hooks.shut_down()\n",
                RAFCON_PLUGIN_PATH=path,
            )
        self.assertEqual(done.stdout, "init A ['/m']\nTrue\nbefore\nafter\n", done.stderr)
        self.assertIn("bad_plugin is left out", done.stderr)


class Libraries(unittest.TestCase):
    def test_they_are_found_below_their_roots(self):
        from rafcon import _runtime
        from rafcon.core.custom_exceptions import LibraryNotFoundException
        from rafcon.core.singleton import library_manager

        with tempfile.TemporaryDirectory() as folder:
            folder = os.path.realpath(folder)
            machine = os.path.join(folder, "lib", "arm", "grasp")
            os.makedirs(machine)
            os.makedirs(os.path.join(folder, "lib_other", "x"))
            pathlib.Path(machine, "statemachine.json").write_text("{}")
            _runtime.configure({"LIBRARY_PATHS": {"own": os.path.join(folder, "lib")}})
            self.addCleanup(_runtime.configure, {})
            self.assertEqual(library_manager.libraries["own"], {"arm": {"grasp": machine}})
            self.assertEqual(library_manager.get_os_path_to_library("own/arm", "grasp"), (machine, "own/arm", "grasp"))
            self.assertEqual(library_manager.get_library_path_and_name_for_os_path(machine), ("own/arm", "grasp"))
            self.assertFalse(
                library_manager.is_os_path_within_library_root_paths(os.path.join(folder, "lib_other", "x"))
            )
            with self.assertRaises(LibraryNotFoundException):
                library_manager.get_os_path_to_library("own", "nothing")


if __name__ == "__main__":
    unittest.main()
