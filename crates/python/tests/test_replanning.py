"""``planning/replan`` in real runs, with an engine that says what it is told to: a step fails, the next plan goes on; what was tried
is not tried again; a runner that dies meanwhile.
"""

import ast
import itertools
import json
import os
import pathlib
import re
import select
import stat
import subprocess
import sys
import tempfile
import textwrap
import unittest

from building import STUCK_S, call
from skills import write_skill
from support import ROOT

BINARY = os.environ.get("RAFCON_BINARY")

GO = "(:action go :parameters (?from ?to - place) :precondition (at ?from) :effect (and (not (at ?from)) (at ?to)))"
#: Into b there is a way from c only, which no fact says. At one place the runner dies once.
GOES = """import os, signal

def execute(self, inputs, outputs, gvm):
    if inputs["to"] == "%s" and not os.path.exists(os.environ["MARK"]):
        open(os.environ["MARK"], "w").close()
        os.kill(os.getpid(), signal.SIGKILL)
    if inputs["to"] == "b" and inputs["from"] != "c":
        raise RuntimeError("a wall")
    return "success"
"""
LOOKS = """def execute(self, inputs, outputs, gvm):
    outputs["facts"] = "(define (problem p) (:domain d) (:objects a b c - place) (:init (at a)) (:goal (at b)))"
    return "success"
"""

#: A machine in which an observer stands beside `planning/replan`, or beside a state with a script of its own.
PROGRAM = """
FOLDER = os.environ["FOLDER"]
global_config.set_config_value("LIBRARY_PATHS", {"pool": FOLDER + "/pool", "planning": os.environ["PLANNING"]})

library_manager.initialize()

mission = HierarchyState("Mission", "MISSON")
mission.add_outcome("success", 0)
plans = mission.add_scoped_variable("plans", "list", [])
look = LibraryState("pool", "look", name="Look", state_id="LOOKXX")
if os.environ.get("SCRIPT"):
    again = ExecutionState("Plan again", "AGAINX")
    again.outcomes[0].name = "replanned"
    again.add_outcome("reached", 1)
    again.add_outcome("given up", 2)
    for name, kind, value in (("facts", "str", ""), ("pool", "list", ["pool"]), ("goal", "str", ""), ("replans_max", "int", 5),
                              ("recovery", "dict", {"then": "replan"}), ("plans", "list", [])):
        again.add_input_data_port(name, kind, value)
    again.add_output_data_port("plans", "list", [])
    again.script_text = os.environ["SCRIPT"]
else:
    again = LibraryState("planning", "replan", name="Plan again", state_id="AGAINX")
port = lambda ports, name: next(key for key, port in ports.items() if port.name == name)
if not os.environ.get("SCRIPT"):
    again.set_input_runtime_value(port(again.input_data_ports, "pool"), ["pool"])
    again.set_input_runtime_value(port(again.input_data_ports, "replans_max"), int(os.environ["REPLANS_MAX"]))
mission.add_state(look)
mission.add_state(again)
mission.set_start_state(look)
mission.add_transition("LOOKXX", 0, "AGAINX", None)
mission.add_transition("AGAINX", 0, "MISSON", -1)
mission.add_transition("AGAINX", 1, "MISSON", 0)
mission.add_transition("AGAINX", 2, "MISSON", -1)
mission.add_data_flow("LOOKXX", port(look.output_data_ports, "facts"), "AGAINX", port(again.input_data_ports, "facts"))
if os.environ["MEMORY"]:
    mission.add_data_flow("MISSON", plans, "AGAINX", port(again.input_data_ports, "plans"))
    mission.add_data_flow("AGAINX", port(again.output_data_ports, "plans"), "MISSON", plans)
root = mission
if os.environ["NESTED"]:
    root = HierarchyState("Outer", "OUTERX")
    root.add_outcome("success", 0)
    root.add_state(mission)
    root.set_start_state(mission)
    root.add_transition("MISSON", 0, "OUTERX", 0)
storage.save_state_machine_to_path(StateMachine(root), FOLDER + "/mission")
"""

STRAIGHT, DETOUR = "(go a b)", "(go a c) (go c b)"


def says(plan):
    """What an engine does that finds this plan."""
    steps = [{"action": f"({step.strip('() ')})"} for step in plan.split(") (")]
    return "echo '%s'" % json.dumps({"steps": steps})


@unittest.skipIf(BINARY is None, "RAFCON_BINARY is not set")
class Replanning(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        # The engine lies beside the interpreter of runs.
        self.bin = self.folder / "bin"
        self.bin.mkdir()
        self.python = self.bin / "python3"
        self.python.symlink_to(sys.executable)

    def mission(self, *answers, replans_max=5, memory="yes", script="", dies_at="", nested=""):
        """Makes the machine, and an engine that does these things one after the other, then says that there is no plan."""
        cases = "\n".join(f"{number}) {answer};;" for number, answer in enumerate(answers, 1))
        program = self.bin / "kairos"
        program.write_text(f"#!/bin/sh\ncd {self.folder}\necho >> calls\ncase $(wc -l < calls) in\n{cases}\n*) exit 10;;\nesac\n")
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        pool = self.folder / "pool"
        write_skill(pool, "go", GO, GOES % dies_at, inputs=("from", "to"))
        write_skill(pool, "look", script=LOOKS, outputs=["facts"])
        self.roots = {"pool": self.folder / "pool", "planning": ROOT / "libraries/planning"}
        call(
            PROGRAM, FOLDER=str(self.folder), PLANNING=str(self.roots["planning"]), REPLANS_MAX=str(replans_max),
            MEMORY=memory, SCRIPT=script, NESTED=nested,
        )

    def run_mission(self, *options):
        """The outcome of a run, the names of the states in it, and what was logged."""
        roots = [word for name, path in self.roots.items() for word in ("--library-path", f"{name}={path}")]
        command = [BINARY, "run", self.folder / "mission", *roots, "--output", "json", "--runs", self.folder / "runs", *options]
        environment = {**os.environ, "RAFCON_PYTHON": str(self.python), "MARK": str(self.folder / "mark")}
        program = subprocess.run([*map(str, command)], env=environment, capture_output=True, text=True, timeout=STUCK_S)
        events = [json.loads(line) for line in program.stdout.splitlines()]
        logged = [event["message"] for event in events if event["type"] == "log"]
        outcome = events[-1].get("outcome") or {"name": program.stdout + program.stderr}
        return outcome["name"], logged

    def steps(self):
        """The names of the steps that ran."""
        (run,) = (path.name for path in (self.folder / "runs").iterdir() if path.is_dir())
        history = [BINARY, "history", run, "--runs", self.folder / "runs", "--kind", "entered"]
        said = subprocess.run([*map(str, history)], capture_output=True, text=True, check=True).stdout
        names = [re.split("  +", line.strip())[2].split("/") for line in said.splitlines()]
        return [name[1] for name in names if len(name) == 2 and name[1] not in ("Look", "Plan again")]

    def test_a_mission_plans_at_its_beginning_and_around_a_failure(self):
        self.mission(says(STRAIGHT), says(DETOUR))
        outcome, logged = self.run_mission()
        self.assertEqual((outcome, logged[-1]), ("success", "a new plan: (go a c), (go c b)"))
        self.assertEqual(self.steps(), ["Go a b", "Go a c", "Go c b"])

    def test_a_plan_that_has_failed_is_not_tried_again(self):
        self.mission(says(STRAIGHT), says(STRAIGHT))
        outcome, logged = self.run_mission()
        self.assertEqual(outcome, "aborted")
        self.assertIn("this plan has failed before: (go a b)", logged)
        self.assertEqual(self.steps(), ["Go a b"])

    def test_it_plans_again_as_often_as_allowed(self):
        three = "(go a c) (go c a) (go a b)"
        self.mission(says(STRAIGHT), says(three), says(DETOUR), replans_max=1)
        outcome, logged = self.run_mission()
        self.assertEqual(outcome, "aborted")
        self.assertIn("it was planned 1 times again, as often as allowed (replans_max)", logged)
        self.assertEqual(self.steps(), ["Go a b", "Go a c", "Go c a", "Go a b"])

    def test_where_there_is_no_other_plan_it_gives_up(self):
        self.mission(says(STRAIGHT))
        outcome, logged = self.run_mission()
        self.assertEqual(outcome, "aborted")
        self.assertIn("no other plan: the goal cannot be reached from these facts with these skills", logged)

    def test_without_a_memory_it_does_not_begin(self):
        self.mission(says(STRAIGHT), memory="")
        outcome, logged = self.run_mission()
        self.assertEqual(outcome, "aborted")
        self.assertIn("nothing remembers the plans that were tried", "\n".join(logged))
        self.assertFalse((self.folder / "calls").exists())

    def test_a_runner_that_dies_while_the_engine_plans_is_followed_by_one_that_plans(self):
        self.mission(says(STRAIGHT), "kill -9 $PPID; exit 3", says(DETOUR))
        outcome, _logged = self.run_mission("--on-crash", "restart")
        self.assertEqual(outcome, "success")
        self.assertEqual(self.steps(), ["Go a b", "Go a c", "Go c b"])

    def test_a_runner_that_dies_when_it_has_replaced_steps_is_followed_by_one_that_replaces_all(self):
        script = """
        import os, signal
        from rafcon.planning import _replanning

        def execute(self, inputs, outputs, gvm):
            inputs["observe"] = "pool/look"
            mark, replace = os.environ["MARK"], _replanning._replace

            def dying(*arguments):
                replace(*arguments)
                open(mark, "w").close()
                os.kill(os.getpid(), signal.SIGKILL)

            if inputs["plans"] and not os.path.exists(mark):
                _replanning._replace = dying
            return _replanning.replan(self, inputs, outputs)
        """
        self.mission(says(STRAIGHT), says(DETOUR), says(DETOUR), script=textwrap.dedent(script))
        outcome, _logged = self.run_mission("--on-crash", "restart")
        self.assertTrue((self.folder / "mark").exists())
        self.assertEqual(outcome, "success")
        self.assertEqual(self.steps(), ["Go a b", "Go a c", "Go c b"])

    def test_a_runner_that_dies_in_a_new_step_is_followed_by_one_that_knows_all_new_steps(self):
        self.mission(says(STRAIGHT), says(DETOUR), dies_at="c")
        outcome, _logged = self.run_mission("--on-crash", "restart")
        self.assertEqual(outcome, "success")
        self.assertEqual(self.steps(), ["Go a b", "Go a c", "Go a c", "Go c b"])

    def layout(self, nested=""):
        """Where the container of a mission stands that has planned twice, and all around and in it."""
        script = """
        from rafcon.planning import replan

        def execute(self, inputs, outputs, gvm):
            inputs["observe"] = "pool/look"
            outcome = replan(self, inputs, outputs)
            layout, around = self._home.layout, self.parent.parent
            self.logger.info("%r", [layout(each) for each in (getattr(around, "states", {}) and around, self.parent, *self.parent.states.values()) if each])
            return outcome
        """
        self.mission(says(STRAIGHT), says(DETOUR), script=textwrap.dedent(script), nested=nested)
        outcome, logged = self.run_mission()
        self.assertEqual(outcome, "success")
        return ast.literal_eval(logged[-1])

    def assert_inside(self, outer, inner):
        (_, _, width, height), (left, top, wide, high) = outer, inner
        self.assertTrue(0 <= left < left + wide < width and 0 <= top < top + high < height, f"{inner} in {outer}")

    def test_everything_stands_in_its_container_and_beside_each_other(self):
        container, *states = self.layout()
        self.assertEqual(len(states), 4)
        for each in states:
            self.assert_inside(container, each)
        for one, other in itertools.combinations(states, 2):
            is_beside = one[0] + one[2] < other[0] or other[0] + other[2] < one[0]
            self.assertTrue(is_beside or one[1] + one[3] < other[1] or other[1] + other[3] < one[1], f"{one} beside {other}")

    def test_what_is_around_the_container_grows_with_it(self):
        around, container, *states = self.layout(nested="yes")
        self.assert_inside(around, container)
        self.assertEqual(len(states), 4)
        for each in states:
            self.assert_inside(container, each)

    def test_an_engine_ends_with_a_program_that_is_killed(self):
        # Its end is the end of all that have it open.
        alive = self.folder / "alive"
        os.mkfifo(alive)
        self.mission("exec 3>alive; sleep 1000000 & exec sleep 1000000")
        facts = self.folder / "facts.pddl"
        facts.write_text("(define (problem p) (:domain d) (:objects a b - place) (:init (at a)) (:goal (at b)))")
        command = [BINARY, "plan", self.folder / "pool", "--facts", facts, "--time-limit", "3600"]
        environment = {**os.environ, "RAFCON_PYTHON": str(self.python)}
        with subprocess.Popen([*map(str, command)], env=environment) as program, open(alive, "rb") as still:
            program.kill()
            self.assertEqual(select.select([still], [], [], STUCK_S)[0], [still])
            self.assertEqual(still.read(), b"")


if __name__ == "__main__":
    unittest.main()
