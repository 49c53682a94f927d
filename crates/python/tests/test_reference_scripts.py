"""The scripts that the reference ships: whatever they import from ``rafcon`` and use of ``self`` and ``gvm`` is here.

Their text is read, nothing of it is run. ``RAFCON_REFERENCE_PYTHON`` names an interpreter with the reference.
"""

import ast
import importlib
import os
import pathlib
import subprocess
import unittest

import stage
from rafcon.core.global_variable_manager import GlobalVariableManager
from rafcon.core.states.barrier_concurrency_state import DeciderState

REFERENCE = os.environ.get("RAFCON_REFERENCE_PYTHON")
#: What a script made itself: it puts the attribute on ``self`` before it reads it.
OWN_ATTRIBUTES = {"turtle_pos_subscriber", "ros_node", "connect", "response", "on_dialog_key_press"}


def scripts():
    question = "import sysconfig; print(sysconfig.get_path('purelib'))"
    site = subprocess.run([REFERENCE, "-c", question], capture_output=True, text=True, check=True).stdout.strip()
    found = sorted(pathlib.Path(site, "rafcon", "share", "rafcon").rglob("script.py"))
    assert found, f"the reference ships no scripts below {site}"
    return found


def trees():
    for script in scripts():
        try:
            yield script, ast.parse(script.read_text(encoding="utf-8"))
        except SyntaxError:
            continue  # one example is broken on purpose


def imports(tree):
    """(module, name or None) of every import of ``rafcon``, without the desktop's."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield from ((node.module, alias.name) for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from ((alias.name, None) for alias in node.names)


def attributes(tree, of):
    """The attributes read of a variable of this name."""
    return {
        node.attr
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == of
    }


@unittest.skipIf(REFERENCE is None, "RAFCON_REFERENCE_PYTHON is not set")
class Scripts(unittest.TestCase):
    def test_their_imports_are_here(self):
        for script, tree in trees():
            for module, name in imports(tree):
                if module.split(".")[0] != "rafcon" or module.startswith("rafcon.gui"):
                    continue
                with self.subTest(script=str(script), module=module, name=name):
                    try:
                        found = importlib.import_module(module)
                    except ModuleNotFoundError as error:
                        self.assertEqual(error.name.split(".")[0], "rclpy")  # needs ROS 2, as ever
                        continue
                    self.assertTrue(name is None or hasattr(found, name))

    def test_what_they_use_of_self_and_gvm_is_here(self):
        stage.native.clear([stage.described("decider", "A", "a", "A")])
        state = stage.native.state_object(0)
        self.assertIsInstance(state, DeciderState)
        for script, tree in trees():
            with self.subTest(script=str(script)):
                self.assertEqual(attributes(tree, "gvm") - set(dir(GlobalVariableManager)), set())
                used = attributes(tree, "self") - OWN_ATTRIBUTES
                self.assertEqual({name for name in used if not hasattr(state, name)}, set())


if __name__ == "__main__":
    unittest.main()
