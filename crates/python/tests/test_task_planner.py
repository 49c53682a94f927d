"""The task planner plugin of the reference, unmodified: it makes a machine of a plan, and the machine runs.

``RAFCON_TASK_PLANNER`` names the unpacked source distribution of ``rafcon-task-planner-plugin``. A planner is a program
of its own, so the plan stands here; everything else, from the skills with their actions to the machine, is the plugin's.
"""

import os
import pathlib
import textwrap
import unittest

from building import call

PLUGIN = os.environ.get("RAFCON_TASK_PLANNER")

PROGRAM = """
import builtins, logging, pathlib, sys, types
plugin = pathlib.Path(os.environ["RAFCON_TASK_PLANNER"])
example = plugin / "examples" / "restaurant_tutorial"
sys.path.insert(0, str(plugin / "source"))
builtins.unicode = str  # the plugin is written for Python 2 here and there

def module(name, **content):
    vars(sys.modules.setdefault(name, types.ModuleType(name))).update(content)

# What the plugin asks of the desktop program: nothing of it makes the machine.
module("rafcon.gui.helpers")
module("rafcon.gui.helpers.state", substitute_state_as=None)
module("rafcon.gui.models")
module("rafcon.gui.models.signals", ActionSignalMsg=None)
module("rafcon.gui.singleton", state_machine_manager_model=None)
module("rafcontpp.hooks")
module("rafcontpp.logic.state_machine_layouter", StateMachineLayouter=lambda: types.SimpleNamespace(
    layout_state_machine=lambda *_arguments: None))

from rafcontpp.logic.mapper import Mapper
from rafcontpp.logic.pddl_action_parser import PddlActionParser
from rafcontpp.logic.pddl_facts_parser import PddlFactsParser
from rafcontpp.logic.state_machine_generator import StateMachineGenerator
from rafcontpp.model.interruptable_thread import InterruptableThread
from rafcontpp.model.pddl_facts_representation import PddlFactsRepresentation
from rafcontpp.model.plan_step import PlanStep

pool = os.path.join(os.environ["OUT"], "skills")
os.mkdir(pool)
for skill in ("cook", "eat", "give", "move", "order"):
    os.symlink(example / "restaurant_state_pool" / skill, os.path.join(pool, skill))
facts_file = example / "facts.pddl"

class Store:
    # Store of the plugin, whose own class runs on Python 2 only.
    def __init__(self, **kept):
        self._kept = kept

    def __getattr__(self, name):
        verb, _, key = name.partition("_")
        if verb == "set":
            return lambda value: self._kept.update({key: value})
        return lambda: self._kept.get(key)

store = Store(state_pools=[pool], sm_name="lunch", sm_save_dir=os.environ["OUT"])
Mapper(store).generate_action_state_map()

actions = {}
for name, skill in store.get_action_state_map().items():
    notes = library_manager.get_library_instance("skills", skill).state_copy.semantic_data
    text = notes["RAFCONTPP"]["PDDL_ACTION"]["pddl_action"]
    actions[name] = types.SimpleNamespace(name=name, parameters=PddlActionParser(text).parse_parameters())
store.set_pddl_action_map(actions)
facts = PddlFactsParser(facts_file.read_text())
store.set_pddl_facts_representation(PddlFactsRepresentation(
    facts_file.read_text(), facts.parse_objects(), facts.parse_domain_name(), facts.parse_problem_name()))
store.set_plan([PlanStep(*step) for step in (
    ("got-to", ["ENTRANCE", "TABLE", "JAMES"]),
    ("order", ["ALICE", "JAMES", "PIZZA", "TABLE"]),
    ("got-to", ["TABLE", "KITCHEN", "JAMES"]),
    ("cook", ["BOB", "PIZZA"]),
    ("give", ["BOB", "JAMES", "PIZZA", "KITCHEN"]),
    ("eat", ["ALICE", "PIZZA"]),
)])
thread = InterruptableThread(target=StateMachineGenerator(store).generate_state_machine)
thread.start()
thread.join()

machine = storage.load_state_machine_from_path(os.path.join(os.environ["OUT"], "lunch"))
state, skills = machine.root_state.get_start_state(), []
while state is not machine.root_state:
    values = {state.input_data_ports[key].name: value for key, value in state.input_data_port_runtime_values.items()}
    print(state.library_name, values)
    to_state = machine.root_state.get_transition_for_outcome(state, state.outcomes[0]).to_state
    state = machine.root_state.states.get(to_state, machine.root_state)
state_machine_manager.delete_all_state_machines()
state_machine_manager.add_state_machine(machine)
logging.basicConfig(stream=sys.stdout, format="%(message)s", level=logging.ERROR)
engine.start(machine.state_machine_id)
engine.join()
print(machine.root_state.final_outcome.name)
"""


@unittest.skipIf(PLUGIN is None, "RAFCON_TASK_PLANNER is not set")
class TaskPlanner(unittest.TestCase):
    def test_it_makes_a_machine_with_the_parameters_of_every_skill_and_the_machine_runs(self):
        said = call(PROGRAM, RAFCON_TASK_PLANNER=str(pathlib.Path(PLUGIN).resolve()))
        expected = """
        move {'destination': 'table', 'name': 'james'}
        order {'interlocutor1': 'alice', 'interlocutor2': 'james', 'food': 'pizza'}
        move {'destination': 'kitchen', 'name': 'james'}
        cook {'chef': 'bob', 'food': 'pizza'}
        give {'interlocutor1': 'bob', 'interlocutor2': 'james', 'food': 'pizza'}
        eat {'person': 'alice', 'food': 'pizza'}
        success
        """
        self.assertEqual(said, textwrap.dedent(expected).lstrip("\n"))


if __name__ == "__main__":
    unittest.main()
