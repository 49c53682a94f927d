"""Plans of a real engine: made by ``rafcon plan`` and by ``rafcon.planning``, run, and made again when a step fails.

``RAFCON_KAIROS_PYTHON`` names a Python with ``kairos-planner`` beside it, ``RAFCON_TASK_PLANNER`` the unpacked source distribution
of the reference's planner plugin.
"""

import json
import os
import pathlib
import subprocess
import tempfile
import textwrap
import unittest

from building import call

PYTHON = os.environ.get("RAFCON_KAIROS_PYTHON")
BINARY = os.environ.get("RAFCON_BINARY")
PLUGIN = os.environ.get("RAFCON_TASK_PLANNER")
EXAMPLES = pathlib.Path(__file__).resolve().parents[3] / "examples"


def rafcon(*arguments):
    """What the program prints; it must succeed."""
    environment = {**os.environ, "RAFCON_PYTHON": PYTHON}
    program = subprocess.run([BINARY, *map(str, arguments)], env=environment, capture_output=True, text=True)
    if program.returncode != 0:
        raise AssertionError(program.stdout + program.stderr)
    return program.stdout


@unittest.skipIf(PYTHON is None or BINARY is None, "RAFCON_KAIROS_PYTHON or RAFCON_BINARY is not set")
class Planning(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_machine(self, machine, root):
        """The names of the states of a run in their order, without their libraries, and its outcome."""
        runs = self.folder / "runs"
        events = rafcon("run", machine, "--library-path", root, "--output", "json", "--runs", runs)
        events = [json.loads(line) for line in events.splitlines()]
        return events[-1]["outcome"]["name"], events

    def test_the_restaurant_of_the_plugin_is_planned_and_runs_unmodified(self):
        if PLUGIN is None:
            self.skipTest("RAFCON_TASK_PLANNER is not set")
        example = pathlib.Path(PLUGIN).resolve() / "examples" / "restaurant_tutorial"
        pool, machine = example / "restaurant_state_pool", self.folder / "lunch"
        files = ["--facts", example / "facts.pddl", "--types", example / "rtpp-typehierarchy.json"]
        said = rafcon("plan", pool, *files, "--out", machine)
        steps = [line.strip().split(" ", 1)[1] for line in said.splitlines() if line[:4].strip().isdigit()]
        expected = """
        Move entrance table james
        Order james alice pizza table
        Move table kitchen james
        Order bob james pizza kitchen
        Cook bob pizza
        Give bob james pizza kitchen
        Move kitchen table james
        Give james alice pizza table
        Eat alice pizza
        """
        self.assertEqual(steps, textwrap.dedent(expected).strip().splitlines())
        root = f"restaurant_state_pool={pool}"
        self.assertIn("no errors, no notes", rafcon("check", machine, "--library-path", root))
        outcome, _events = self.run_machine(machine, root)
        self.assertEqual(outcome, "success")

    def test_a_rover_fetches_and_assembles_though_a_step_fails(self):
        root, machine = f"examples={EXAMPLES}/libraries", self.folder / "fetch"
        facts = EXAMPLES / "fetch_and_assemble" / "facts.pddl"
        replanning = ["--then", "replan", "--observe", "examples/rover/observe"]
        rafcon("plan", "examples/rover", "--library-path", root, "--facts", facts, *replanning, "--out", machine)
        self.assertIn("no errors, no notes", rafcon("check", machine, "--library-path", root))
        outcome, events = self.run_machine(machine, root)
        self.assertEqual(outcome, "success")
        text = json.dumps(events)
        self.assertIn("the mug slips and rolls into the crater", text)
        self.assertIn("a new plan: (drive ridge base), (drive base crater), (pick mug crater)", text)

    def test_the_same_plan_is_never_tried_twice(self):
        root, machine = f"examples={EXAMPLES}/libraries", self.folder / "fetch"
        facts = EXAMPLES / "fetch_and_assemble" / "facts.pddl"
        replanning = ["--then", "replan", "--observe", "examples/rover/observe", "--replans-max", "0"]
        rafcon("plan", "examples/rover", "--library-path", root, "--facts", facts, *replanning, "--out", machine)
        runs = self.folder / "runs"
        with self.assertRaisesRegex(AssertionError, "as often as allowed"):
            rafcon("run", machine, "--library-path", root, "--runs", runs)

    def test_python_plans_and_builds(self):
        program = """
        from rafcon import planning
        global_config.set_config_value("LIBRARY_PATHS", {"examples": os.environ["EXAMPLES"]})
        library_manager.initialize()
        facts = open(os.environ["FACTS"]).read()
        plan = planning.plan("examples/rover", facts, "(rover-at ridge)")
        print(plan.explain())
        machine = plan.to_machine()
        print(type(machine.root_state).__name__, [state.name for state in machine.root_state.states.values()])
        for change in (
            dict(goal="(rover-at moon)"), dict(goal="(and (at mug base) (holding mug))"),
            dict(engine="nobody", goal="(rover-at ridge)"), dict(pool="examples/nowhere"),
        ):
            try:
                planning.plan(**{"pool": "examples/rover", "facts": facts, **change})
            except planning.PlanningError as error:
                print(type(error).__name__)
        """
        said = call(
            textwrap.dedent(program),
            python=PYTHON,
            EXAMPLES=str(EXAMPLES / "libraries"),
            FACTS=str(EXAMPLES / "fetch_and_assemble" / "facts.pddl"),
        )
        expected = """
        1 (drive base ridge)
          needs (rover-at base)
          brings (rover-at ridge) for the goal
        HierarchyState ['Drive base ridge']
        Refused
        Unsolvable
        EngineError
        Refused
        """
        self.assertEqual(said, textwrap.dedent(expected).lstrip("\n"))


if __name__ == "__main__":
    unittest.main()
