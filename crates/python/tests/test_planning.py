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
from skills import write_skill

PYTHON = os.environ.get("RAFCON_KAIROS_PYTHON")
BINARY = os.environ.get("RAFCON_BINARY")
PLUGIN = os.environ.get("RAFCON_TASK_PLANNER")
ROOT = pathlib.Path(__file__).resolve().parents[3]
EXAMPLES = ROOT / "examples"
PLANNING = f"planning={ROOT}/libraries/planning"


def rafcon(*arguments):
    """What the program prints; it must succeed."""
    environment = {**os.environ, "RAFCON_PYTHON": PYTHON}
    program = subprocess.run([BINARY, *map(str, arguments)], env=environment, capture_output=True, text=True)
    if program.returncode != 0:
        raise AssertionError(program.stdout + program.stderr)
    return program.stdout


def given(roots):
    """Library roots as options."""
    return [word for root in roots for word in ("--library-path", root)]


@unittest.skipIf(PYTHON is None or BINARY is None, "RAFCON_KAIROS_PYTHON or RAFCON_BINARY is not set")
class Planning(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_machine(self, machine, *roots):
        """The outcome of a run, and its events."""
        runs = self.folder / "runs"
        events = rafcon("run", machine, *given(roots), "--output", "json", "--runs", runs)
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
        roots = (root, PLANNING)
        rafcon("plan", "examples/rover", *given(roots), "--facts", facts, *replanning, "--out", machine)
        self.assertIn("no errors, no notes", rafcon("check", machine, *given(roots)))
        outcome, events = self.run_machine(machine, *roots)
        self.assertEqual(outcome, "success")
        text = json.dumps(events)
        self.assertIn("the mug slips and rolls into the crater", text)
        self.assertIn("a new plan: (drive ridge base), (drive base crater), (pick mug crater)", text)

    def test_the_same_plan_is_never_tried_twice(self):
        root, machine = f"examples={EXAMPLES}/libraries", self.folder / "fetch"
        facts = EXAMPLES / "fetch_and_assemble" / "facts.pddl"
        replanning = ["--then", "replan", "--observe", "examples/rover/observe", "--replans-max", "0"]
        rafcon("plan", "examples/rover", *given((root, PLANNING)), "--facts", facts, *replanning, "--out", machine)
        runs = self.folder / "runs"
        with self.assertRaisesRegex(AssertionError, "as often as allowed"):
            rafcon("run", machine, *given((root, PLANNING)), "--runs", runs)

    def test_a_rover_made_from_the_template_plans_its_mission_by_itself(self):
        machine, roots = self.folder / "rover", (f"examples={EXAMPLES}/libraries", PLANNING)
        rafcon("new", machine, "--template", "rover")
        outcome, events = self.run_machine(machine, *roots)
        self.assertEqual(outcome, "success")
        plans = [event["message"] for event in events if event["type"] == "log" and "a new plan" in event["message"]]
        self.assertEqual(len(plans), 2)

    def lift(self, script):
        """A pool in which two rovers drive, one of them loads, then both lift."""
        pool = self.folder / "yard"
        for name, takes, needs, brings in (
            ("drive_far", 5, "(ready)", "(far)"), ("drive_near", 3, "(ready)", "(near)"),
            ("load", 2, "(near)", "(loaded)"), ("lift", 1, "(and (far) (loaded))", "(lifted)"),
        ):
            action = f"(:durative-action {name} :parameters () :duration (= ?duration {takes}) " \
                     f":condition (at start {needs}) :effect (at end {brings}))"
            write_skill(pool, name, action, script % name)
        facts = self.folder / "yard.pddl"
        facts.write_text("(define (problem lift) (:domain yard) (:init (ready)) (:goal (lifted)))")
        return pool, facts

    def test_what_a_temporal_plan_does_at_the_same_time_its_machine_does_at_the_same_time(self):
        # Each meets those that it overlaps with; alone, it would wait for ever.
        script = textwrap.dedent("""
            import sys, threading

            MEETINGS = {"drive_far": ("driving", "loading"), "drive_near": ("driving",), "load": ("loading",)}

            def execute(self, inputs, outputs, gvm):
                for name in MEETINGS.get("%s", ()):
                    sys.modules.setdefault("meeting " + name, threading.Barrier(2)).wait(60)
                return "success"
        """)
        (pool, facts), machine = self.lift(script), self.folder / "lift"
        found = json.loads(rafcon("plan", pool, "--facts", facts, "--json", "--out", machine).splitlines()[0])
        self.assertEqual((found["temporal"], round(found["makespan"], 1), round(found["lost"], 1)), (True, 6.0, 0.0))
        root = f"yard={pool}"
        self.assertIn("no errors, no notes", rafcon("check", machine, "--library-path", root))
        outcome, events = self.run_machine(machine, root)
        self.assertEqual(outcome, "success")
        times = {}
        for at, event in enumerate(events):
            if event["type"] in ("entered", "left"):
                times.setdefault(event["path"], []).append(at)
        steps = found["steps"]
        self.assertEqual({step["action"] for step in steps}, {"drive_far", "drive_near", "load", "lift"})
        end = lambda step: step["start"] + step["duration"]
        for one in steps:
            for other in steps:
                overlaps = one["start"] < end(other) - 0.01 and other["start"] < end(one) - 0.01
                (begun, _), (_, ended) = times[one["path"]], times[other["path"]]
                if overlaps:
                    self.assertLess(begun, ended, (one["title"], other["title"]))
                elif one["start"] > other["start"]:
                    self.assertGreater(begun, ended, (one["title"], other["title"]))

    def test_the_time_that_a_machine_loses_is_told(self):
        pool = self.folder / "yard"
        for name, takes, needs, brings in (
            ("a", 5, "(ready)", "(pa)"), ("b", 1, "(ready)", "(pb)"), ("c", 1, "(and (pa) (pb))", "(pc)"), ("d", 5, "(pb)", "(pd)"),
        ):
            action = f"(:durative-action {name} :parameters () :duration (= ?duration {takes}) " \
                     f":condition (at start {needs}) :effect (at end {brings}))"
            write_skill(pool, name, action)
        facts, machine = self.folder / "yard.pddl", self.folder / "abcd"
        facts.write_text("(define (problem p) (:domain yard) (:init (ready)) (:goal (and (pc) (pd))))")
        said = rafcon("plan", pool, "--facts", facts, "--out", machine)
        # Engines leave a thousandth between what depends on each other.
        self.assertRegex(said, r"4 steps, takes 6(\.\d{1,3})?, its machine (4|3\.99\d) longer; valid")
        outcome, _events = self.run_machine(machine, f"yard={pool}")
        self.assertEqual(outcome, "success")

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
