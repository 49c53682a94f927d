"""Runs programs that build machines: with this package as if it were installed, or with the reference."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import textwrap

from support import EXTENSION, ROOT

REFERENCE = os.environ.get("RAFCON_REFERENCE_PYTHON")
PACKAGE = ROOT / "crates/python/python"
#: A program that takes longer than this is stuck; no test's answer depends on it.
STUCK_S = 60

PROLOGUE = """
import importlib.machinery, importlib.util, sys
sys.path.insert(0, %r)
loader = importlib.machinery.ExtensionFileLoader("rafcon._native", %r)
spec = importlib.util.spec_from_file_location("rafcon._native", loader.path, loader=loader)
sys.modules["rafcon._native"] = importlib.util.module_from_spec(spec)
loader.exec_module(sys.modules["rafcon._native"])
"""

#: What every program of a test begins with.
NAMES = """
import os
from rafcon.core.config import global_config
from rafcon.core.singleton import (
    global_variable_manager as gvm, library_manager, state_machine_execution_engine as engine, state_machine_manager
)
from rafcon.core.state_elements.data_flow import DataFlow
from rafcon.core.state_elements.data_port import InputDataPort, OutputDataPort
from rafcon.core.state_elements.logical_port import Outcome
from rafcon.core.state_elements.scope import ScopedVariable
from rafcon.core.state_elements.transition import Transition
from rafcon.core.state_machine import StateMachine
from rafcon.core.states.barrier_concurrency_state import BarrierConcurrencyState, DeciderState
from rafcon.core.states.execution_state import ExecutionState
from rafcon.core.states.hierarchy_state import HierarchyState
from rafcon.core.states.library_state import LibraryState
from rafcon.core.states.preemptive_concurrency_state import PreemptiveConcurrencyState
from rafcon.core.storage import storage

def refused(change, *arguments, **named):
    try:
        change(*arguments, **named)
    except Exception as error:
        print(type(error).__name__)
    else:
        print("done")
"""


def call(program, python=sys.executable, prologue=None, **environment):
    """What a program prints; ``OUT`` names a folder of its own."""
    return called(program, python, prologue, **environment)[0]


def called(program, python=sys.executable, prologue=None, **environment):
    """What a program prints, and what it says on stderr."""
    prologue = PROLOGUE % (str(PACKAGE), EXTENSION) if prologue is None else prologue
    with tempfile.TemporaryDirectory() as home:
        ended = subprocess.run(
            [python, "-c", prologue + NAMES + textwrap.dedent(program)],
            capture_output=True,
            text=True,
            timeout=STUCK_S,
            cwd=home,
            env={**os.environ, "HOME": home, "RAFCON_LIBRARY_PATH": "", "OUT": home, **environment},
        )
    assert ended.returncode == 0, ended.stderr
    return ended.stdout, ended.stderr


def shown(output):
    """Without what differs from run to run."""
    return re.sub(r"(?m)^.* - rafcon.*\n", "", output)


def files(folder):
    """Path below the folder to text, of the files of a machine; what is made by chance or time is replaced."""
    folder = pathlib.Path(folder)
    found = {}
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            found[str(path.relative_to(folder))] = path.read_text(encoding="utf-8")
    header = found.get("statemachine.json", "")
    header = re.sub(r'("creation_time": )"[^"]*"', r'\1"then"', header)
    found["statemachine.json"] = re.sub(r'("used_rafcon_version": )"[^"]*"', r'\1"that"', header)
    return found
