"""Plans the example of the planner plugin by the plugin, unmodified, and prints how long it takes: ``PLUGIN KAIROS``.

The plugin is for Python 2 here and there: what it misses of that is put beside it, as is what it asks of the desktop program.
"""

import builtins
import json
import os
import pathlib
import sys
import tempfile
import threading
import time
import types

PLUGIN, KAIROS = pathlib.Path(sys.argv[1]), sys.argv[2]
EXAMPLE = PLUGIN / "examples" / "restaurant_tutorial"
POOL = str(EXAMPLE / "restaurant_state_pool")
ENGINE = """
import json, subprocess
from rafcontpp.model.plan_step import PlanStep
from rafcontpp.model.planner_interface import PlannerInterface
from rafcontpp.model.planning_report import PlanningReport

class Kairos(PlannerInterface):
    def plan_scenario(self, domain_path, facts_path, planner_argv, storage_path):
        words = [%r, "solve", domain_path, facts_path, "--format", "json", "--threads", "1", "--no-anytime"]
        said = subprocess.run(words, capture_output=True, text=True, check=True).stdout
        steps = [step["action"].strip("()").upper().split() for step in json.loads(said.splitlines()[-1])["steps"]]
        return PlanningReport(True, [PlanStep(name, objects) for name, *objects in steps], [])
"""


def module(name, **content):
    vars(sys.modules.setdefault(name, types.ModuleType(name))).update(content)


class Text(str):
    def encode(self, *_how):
        return str(self)


class Table(dict):
    iteritems = dict.items


class Store:
    """Store of the plugin, whose own class runs on Python 2 only."""

    def __init__(self, **kept):
        self._kept = kept

    def __getattr__(self, name):
        verb, _, key = name.partition("_")
        if verb in ("set", "add"):
            return lambda value, *_more: self._kept.update({key: value})
        if verb in ("register", "remove"):
            return lambda *_arguments: 1
        return lambda: self._kept.get(key if verb == "get" else name)


builtins.unicode = str
sys.path.insert(0, str(PLUGIN / "source"))
module("rafcon.gui.helpers")
module("rafcon.gui.helpers.state", substitute_state_as=None)
module("rafcon.gui.models")
module("rafcon.gui.models.signals", ActionSignalMsg=None)
module("rafcon.gui.singleton", state_machine_manager_model=None)
module("rafcon.gui.utils", wait_for_gui=lambda *_arguments: None)
module("rafcontpp.hooks")
layouter = types.SimpleNamespace(layout_state_machine=lambda *_arguments: None)
module("rafcontpp.logic.state_machine_layouter", StateMachineLayouter=lambda: layouter)

from rafcon.core.config import global_config
from rafcon.core.singleton import library_manager
from rafcontpp.control import execution_controller
from rafcontpp.logic import pddl_action_loader, state_machine_generator, type_merger

pddl_action_loader.unicodedata = types.SimpleNamespace(normalize=lambda _form, text: Text(text))
type_merger.json = types.SimpleNamespace(load=lambda file: Table(json.load(file)))
state_machine_generator.call_gui_callback = lambda call, *arguments: call(*arguments)
MARKS = {}


class Generator(state_machine_generator.StateMachineGenerator):
    def generate_state_machine(self):
        MARKS["planned"] = time.perf_counter()
        try:
            super().generate_state_machine()
        finally:
            MARKS["built"] = time.perf_counter()


execution_controller.StateMachineGenerator = Generator
with tempfile.TemporaryDirectory() as folder:
    pathlib.Path(folder, "with_kairos.py").write_text(ENGINE % KAIROS)
    sys.path.insert(0, folder)
    global_config.load(path=folder)
    global_config.set_config_value("LIBRARY_PATHS", {os.path.basename(POOL): POOL})
    library_manager.initialize()
    store = Store(
        state_pools=[POOL], sm_name="lunch", sm_save_dir=folder, file_save_dir=folder, keep_related_files=True,
        domain_path=os.path.join(folder, "domain.pddl"), facts_path=str(EXAMPLE / "facts.pddl"), planner="kairos",
        type_db_path=str(EXAMPLE / "rtpp-typehierarchy.json"), planner_argv=[],
        built_in_planners={"kairos": ("with_kairos", "Kairos")},
    )
    begin = time.perf_counter()
    execution_controller.ExecutionController(store).on_execute_pre_planning()
    for thread in threading.enumerate():
        if thread.name == "PlanningThread":
            thread.join()
    is_there = os.path.exists(os.path.join(folder, "lunch", "statemachine.json"))
plan_ms, build_ms = (MARKS["planned"] - begin) * 1000, (MARKS["built"] - MARKS["planned"]) * 1000
answer = {"steps": len(store.get_plan()) if is_there else 0, "plan_ms": plan_ms, "build_ms": build_ms}
print(json.dumps(answer), flush=True)
os._exit(0)
