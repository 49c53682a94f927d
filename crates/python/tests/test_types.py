"""Types of the package, for checkers and editors: every public name has a stub, and a program is checked against them."""

import ast
import importlib.util
import pathlib
import subprocess
import sys
import tempfile
import textwrap
import unittest
import venv

from building import PACKAGE

PROGRAM = '''
    from typing import Any

    from rafcon.core.global_variable_manager import GlobalVariableManager
    from rafcon.core.singleton import (
        global_variable_manager, library_manager, state_machine_execution_engine, state_machine_manager
    )
    from rafcon.core.state_elements.logical_port import Outcome
    from rafcon.core.state_machine import StateMachine
    from rafcon.core.states.barrier_concurrency_state import BarrierConcurrencyState, DeciderState
    from rafcon.core.states.container_state import ContainerState
    from rafcon.core.states.execution_state import ExecutionState
    from rafcon.core.states.hierarchy_state import HierarchyState
    from rafcon.core.states.library_state import LibraryState
    from rafcon.core.states.state import State
    from rafcon.core.storage import storage
    from rafcon.utils.log import get_logger

    def execute(self: ExecutionState, inputs: dict[str, Any], outputs: dict[str, Any], gvm: GlobalVariableManager) -> str:
        outputs["number"] = inputs["number"] + gvm.get_variable("step", default=1)
        return "preempted" if self.preemptive_wait(0.1) else "success"

    def build() -> StateMachine:
        count = ExecutionState("Count", outcomes=[Outcome(0, "success")])
        port = count.add_output_data_port("number", int, 0)
        barrier = BarrierConcurrencyState("Both", decider_state=DeciderState("Judge"))
        library = LibraryState("generic", "wait", name="Wait")
        library.input_data_port_runtime_values[0] = 3
        root = HierarchyState("Root")
        for state in (count, barrier, library):
            root.add_state(state)
        root.set_start_state(count)
        root.add_transition(count.state_id, 0, root.state_id, 0)
        root.add_data_flow(count.state_id, port, root.state_id, root.add_scoped_variable("number", int))
        return StateMachine(root)

    def names(container: ContainerState) -> list[str]:
        return [state.name for state in container.states.values()]

    def run(machine: StateMachine) -> str:
        library_manager.initialize()
        global_variable_manager.set_variable("step", 2)
        state_machine_manager.add_state_machine(machine)
        state_machine_execution_engine.start(machine.state_machine_id, inputs={"x": 1}, journal=True)
        if not state_machine_execution_engine.join(timeout=3):
            state_machine_execution_engine.stop()
        get_logger("program").info("%s", names(machine.root_state))
        storage.save_state_machine_to_path(machine, "out")
        first: State = machine.root_state.states["COUNT"]
        outcome: str = machine.root_state.final_outcome.name
        return f"{first.outcomes[0].name} {outcome} {state_machine_execution_engine.status.execution_mode.name}"
'''


class Stubs(unittest.TestCase):
    maxDiff = None

    def test_every_public_name_has_a_stub(self):
        for path in sorted(PACKAGE.rglob("*.py")):
            if _is_private(path.relative_to(PACKAGE)) or not _signatures(path):
                continue
            with self.subTest(str(path.relative_to(PACKAGE))):
                stub = path.with_suffix(".pyi")
                self.assertTrue(stub.is_file(), f"write {stub.name}")
                own, known = _signatures(path), _signatures(stub)
                self.assertEqual(sorted(own - known), [], "not in the stub")
                self.assertEqual(sorted(known - own), [], "only in the stub")
                self.assertEqual(_bare(stub), [])


@unittest.skipUnless(importlib.util.find_spec("mypy"), "needs mypy")
class Checked(unittest.TestCase):
    def check(self, program, expected):
        with tempfile.TemporaryDirectory() as home:
            program_file = pathlib.Path(home, "program.py")
            program_file.write_text(textwrap.dedent(program), encoding="utf-8")
            python = _installed(pathlib.Path(home, "venv"))
            words = [sys.executable, "-m", "mypy", "--strict", "--python-executable", python, "--no-error-summary"]
            words += ["--cache-dir", home + "/cache", "program.py"]
            ended = subprocess.run(words, capture_output=True, text=True, cwd=home)
            self.assertEqual(ended.stdout + ended.stderr, textwrap.dedent(expected).lstrip("\n"))

    def test_a_program_passes_the_strict_check(self):
        self.check(PROGRAM, "")

    def test_what_is_known_is_shown_and_slips_are_found(self):
        self.check(
            """
            from rafcon.core.states.hierarchy_state import HierarchyState

            root = HierarchyState("root")
            reveal_type(root.states["X"])
            reveal_type(root.outcomes[0])
            root.add_outcome(3)
            root.add_stat(root)
            """,
            """
            program.py:5: note: Revealed type is "rafcon.core.states.state.State"
            program.py:6: note: Revealed type is "rafcon.core.state_elements.logical_port.Outcome"
            program.py:7: error: Argument 1 to "add_outcome" of "StateChanges" has incompatible type "int"; expected "str"  [arg-type]
            program.py:8: error: "HierarchyState" has no attribute "add_stat"  [attr-defined]
            """,
        )


def _installed(folder):
    """The interpreter of an environment that has the package as an installer would lay it out."""
    venv.create(folder, symlinks=True)
    python = folder / "bin" / "python"
    words = [python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"]
    packages = subprocess.run(words, capture_output=True, text=True, check=True).stdout.strip()
    pathlib.Path(packages, "rafcon").symlink_to(PACKAGE / "rafcon")
    return str(python)


def _is_private(path):
    return any(part.startswith("_") and part != "__init__.py" for part in path.parts)


def _signatures(path):
    """The public functions, classes, methods and properties of a file, with the names of their parameters."""
    found = set()
    for owner, node in _members(path):
        if isinstance(node, ast.FunctionDef):
            words = node.args
            named = [word.arg for word in [*words.posonlyargs, *words.args, words.vararg, *words.kwonlyargs, words.kwarg] if word]
            found.add(f"{owner}{node.name}({', '.join(named)})")
        elif isinstance(node, ast.ClassDef):
            found.add(f"class {node.name}")
        elif isinstance(node, ast.Assign) and _made_by(node) in ("field", "property"):
            found.add(f"{owner}{node.targets[0].id}(self)")
        elif isinstance(node, ast.Assign) and _made_by(node) == "Enum":
            found.add(f"class {node.targets[0].id}")
    return found


def _made_by(node):
    """The function whose call an assignment assigns."""
    return getattr(getattr(node.value, "func", None), "id", None)


def _bare(path):
    """The functions of a stub with a parameter or a result without a type."""
    bare = []
    for owner, node in _members(path):
        if isinstance(node, ast.FunctionDef):
            words = [*node.args.args, node.args.vararg, *node.args.kwonlyargs, node.args.kwarg]
            plain = [word for word in words if word and word.arg not in ("self", "cls") and word.annotation is None]
            if plain or node.returns is None:
                bare.append(owner + node.name)
    return bare


def _members(path):
    body = ast.parse(path.read_text(encoding="utf-8")).body
    for node in body:
        if _is_public(node):
            yield "", node
        if isinstance(node, ast.ClassDef) and _is_public(node):
            for member in node.body:
                if _is_public(member):
                    yield node.name + ".", member


def _is_public(node):
    name = node.targets[0].id if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name) else "_"
    name = getattr(node, "name", name)
    return not name.startswith("_") or (name == "__init__" and isinstance(node, ast.FunctionDef))


if __name__ == "__main__":
    unittest.main()
