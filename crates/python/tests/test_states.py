"""The objects that scripts get: what they say of the machine, and what they refuse."""

import unittest

import stage
from rafcon import _runtime
from rafcon.core.custom_exceptions import CommandNotSupported, MachineChangeNotSupported
from rafcon.core.singleton import state_machine_execution_engine as engine
from rafcon.core.singleton import state_machine_manager
from rafcon.core.state_elements.data_port import InputDataPort, OutputDataPort
from rafcon.core.state_elements.logical_port import Outcome
from rafcon.core.states.barrier_concurrency_state import BarrierConcurrencyState, DeciderState
from rafcon.core.states.container_state import ContainerState
from rafcon.core.states.execution_state import ExecutionState
from rafcon.core.states.hierarchy_state import HierarchyState
from rafcon.core.states.library_state import LibraryState
from rafcon.core.states.preemptive_concurrency_state import PreemptiveConcurrencyState
from rafcon.core.states.state import State, StateExecutionStatus
from rafcon.core.storage import storage

ROOT, FIRST, LIBRARY, INNER, DECIDER = range(5)

TABLE = [
    stage.described(
        "hierarchy",
        "ROOT",
        "mission",
        "ROOT",
        children={"FIRST": FIRST, "LIB": LIBRARY},
        transitions={
            1: (None, None, "FIRST", None),
            2: ("FIRST", 0, "LIB", None),
            3: ("FIRST", 1, "FIRST", None),
            4: ("LIB", 0, "ROOT", 0),
        },
        data_flows={1: ("ROOT", 5, "FIRST", 0)},
        scoped_variables={5: ("count", "builtins.int", 3)},
    ),
    stage.described(
        "execution",
        "FIRST",
        "look around",
        "ROOT/FIRST",
        ROOT,
        description="turns once",
        outcomes={-1: "aborted", -2: "preempted", 0: "success", 1: "again"},
        inputs={0: ("count", "builtins.int", 7), 1: ("image", "not_there.Image", None)},
        outputs={2: ("found", "builtins.list", [])},
        semantic_data={"tool": {"gripper": "open"}},
        script="def execute(self, inputs, outputs, gvm):\n    return 0\n",
        file_system_path="/m/look_around_FIRST",
    ),
    stage.described(
        "library",
        "LIB",
        "fetch",
        "ROOT/LIB",
        ROOT,
        children={"INNER": INNER},
        library={
            "path": "generic",
            "name": "fetch",
            "version": "None",
            "input_runtime_values": {0: "hi"},
            "output_runtime_values": {},
            "use_input_runtime_values": {0: True},
            "use_output_runtime_values": {},
        },
    ),
    stage.described(
        "barrier", "INNER", "both", "ROOT/LIB/INNER", LIBRARY, children={"unique_decider_state_id": DECIDER}
    ),
    stage.described("decider", "unique_decider_state_id", "Decider", "ROOT/LIB/INNER/unique_decider_state_id", INNER),
]


class Stage(unittest.TestCase):
    def setUp(self):
        stage.native.clear(TABLE)
        self.root, self.first, self.library, self.inner, self.decider = map(stage.native.state_object, range(5))


class Identity(Stage):
    def test_a_state_knows_who_it_is(self):
        self.assertEqual(self.first.name, "look around")
        self.assertEqual(self.first.state_id, "FIRST")
        self.assertEqual(self.first.description, "turns once")
        self.assertEqual(self.first.get_path(), "ROOT/FIRST")
        self.assertEqual(self.first.get_path(by_name=True), "root/first")
        self.assertEqual(self.first.get_path("X"), "ROOT/FIRST/X")
        self.assertEqual(self.first.file_system_path, "/m/look_around_FIRST")
        self.assertEqual(self.first.logger.name, "rafcon.look around")
        self.assertEqual(str(self.first), "ExecutionState with name 'look around' and id 'FIRST'")
        self.assertEqual(str(self.root), "HierarchyState with name 'mission' and id 'ROOT' [2 child states]")

    def test_each_kind_has_its_class(self):
        kinds = [HierarchyState, ExecutionState, LibraryState, BarrierConcurrencyState, DeciderState]
        states = [self.root, self.first, self.library, self.inner, self.decider]
        self.assertEqual([type(state) for state in states], kinds)
        self.assertTrue(issubclass(DeciderState, ExecutionState) and issubclass(HierarchyState, ContainerState))
        self.assertTrue(issubclass(PreemptiveConcurrencyState, State))

    def test_the_tree_is_made_of_the_same_objects(self):
        self.assertIs(self.first.parent, self.root)
        self.assertIs(self.root.states["FIRST"], self.first)
        self.assertIs(self.library.state_copy, self.inner)
        self.assertIs(self.inner.parent, self.library)
        self.assertIs(self.decider.parent, self.inner)
        self.assertEqual(list(self.root.states.keys()), ["FIRST", "LIB"])
        self.assertIn("FIRST", self.root.states)
        self.assertIn(self.first, self.root)

    def test_the_state_machine_is_above_the_root(self):
        machine = self.first.get_state_machine()
        self.assertIs(self.root.parent, machine)
        self.assertIs(machine.root_state, self.root)
        self.assertTrue(self.root.is_root_state and not self.first.is_root_state)
        self.assertFalse(hasattr(machine, "parent"))
        self.assertIs(machine.get_state_by_path("ROOT/LIB/INNER"), self.inner)
        self.assertIsNone(machine.get_state_by_path("ROOT/NOBODY", as_check=True))
        self.assertEqual((machine.file_system_path, machine.state_machine_id), ("/m", 1))
        self.assertEqual(state_machine_manager.state_machines, {1: machine})

    def test_roots_of_libraries_are_found(self):
        self.assertTrue(self.inner.is_root_state_of_library and not self.inner.is_root_state)
        self.assertIs(self.decider.get_next_upper_library_root_state(), self.inner)
        self.assertIs(self.decider.get_uppermost_library_root_state(), self.inner)
        self.assertIsNone(self.first.get_next_upper_library_root_state())


class Parts(Stage):
    def test_outcomes(self):
        self.assertEqual(self.first.outcomes[1], Outcome(1, "again"))
        self.assertIs(self.first.outcomes[1].parent, self.first)
        self.assertEqual(str(self.first.outcomes[0]), "Outcome 'success' [0]")

    def test_ports(self):
        count, image = self.first.input_data_ports.values()
        self.assertEqual((count.name, count.data_type, count.default_value), ("count", int, 7))
        self.assertEqual(image.data_type, "not_there.Image")
        self.assertEqual(self.first.get_io_data_port_id_from_name_and_type("found", OutputDataPort), 2)
        with self.assertRaises(AttributeError):
            self.first.get_io_data_port_id_from_name_and_type("nothing", InputDataPort)
        self.assertIs(self.first.get_data_port_by_id(0), count)

    def test_connections(self):
        self.assertEqual(self.root.start_state_id, "FIRST")
        self.assertIs(self.root.get_start_state(), self.first)
        transition = self.root.get_transition_for_outcome(self.first, self.first.outcomes[0])
        self.assertEqual(transition.to_dict(), {
            "transition_id": 2, "from_state": "FIRST", "from_outcome": 0, "to_state": "LIB", "to_outcome": None,
        })  # fmt: skip
        self.assertIs(self.root.get_state_for_transition(transition), self.library)
        transitions, flows = self.root.get_connections_for_state("FIRST")
        ids = {kind: [t.transition_id for t in found] for kind, found in transitions["external"].items()}
        self.assertEqual(ids, {"ingoing": [1], "outgoing": [2], "self": [3]})
        self.assertEqual(len(flows["external"]["ingoing"]), 1)
        variable = self.root.scoped_variables[5]
        self.assertEqual(self.root.get_data_flow_id(variable, self.first.input_data_ports[0]), 1)

    def test_scoped_variables(self):
        stage.native.live[ROOT] = {"scoped_data": {"count": 42}}
        self.assertEqual(self.root.get_scoped_variable_from_name("count"), 5)
        self.assertEqual(self.root.scoped_data["5ROOT"].value, 42)

    def test_library(self):
        self.assertEqual((self.library.library_path, self.library.library_name), ("generic", "fetch"))
        self.assertEqual(self.library.input_data_port_runtime_values, {0: "hi"})
        self.assertEqual(self.library.use_runtime_value_input_data_ports, {0: True})

    def test_script(self):
        self.assertEqual(self.first.script_text, self.first.script.script)
        self.assertEqual(self.first.script.filename, "script.py")
        self.assertEqual(self.first.script.path, "/m/look_around_FIRST")

    def test_semantic_data(self):
        self.assertEqual(self.first.semantic_data["tool"]["gripper"], "open")
        self.assertEqual(self.first.add_semantic_data(["tool"], {"mm": "40"}, "width"), ["tool", "width"])
        self.assertEqual(self.first.get_semantic_data(["tool", "width", "mm"]), "40")
        self.assertEqual(self.first.remove_semantic_data(["tool", "gripper"]), "open")
        with self.assertRaises(KeyError):
            self.first.get_semantic_data(["tool", "gripper"])


class Run(Stage):
    def test_what_a_script_keeps_stays(self):
        self.first.persistent_variables["n"] = 1
        self.first.anything = [1, 2]
        again = self.root.states["FIRST"]
        self.assertEqual((again.persistent_variables, again.anything), ({"n": 1}, [1, 2]))

    def test_flags(self):
        self.assertFalse(self.first.preempted or self.first.paused or self.first.started)
        self.first._preempted.set()
        self.assertTrue(self.first.preempted and self.first._interrupted.is_set() and self.first._unpaused.is_set())
        self.first._preempted.clear()
        self.assertFalse(self.first.preempted)
        self.first.paused = True
        self.assertTrue(self.first._paused.is_set() and not self.first._unpaused.is_set())
        with self.assertRaises(TypeError):
            self.first.preempted = 1

    def test_waits(self):
        self.assertFalse(self.first.preemptive_wait(0))
        self.assertFalse(self.first.preemptive_wait(-1))
        self.first.paused = True
        self.assertTrue(self.first.wait_for_interruption())
        self.assertFalse(self.first.wait_for_unpause(0.0))
        self.first.started = True
        self.assertTrue(self.first.wait_for_unpause())
        self.first.preempted = True
        self.assertTrue(self.first.preemptive_wait(float("inf")))
        self.assertTrue(self.first._preempted.wait())
        self.assertEqual(self.first._signals.waits[-2:], [(1, None), (1, None)])

    def test_preemption_of_all_that_is_inside(self):
        self.root.recursively_preempt_states()
        for state in (self.root, self.first, self.library, self.inner, self.decider):
            self.assertTrue(state.preempted)

    def test_live_data(self):
        stage.native.live[FIRST] = {"input_data": {"count": 1}, "final_outcome": (1, "again"), "phase": "waiting"}
        self.assertEqual(self.first.input_data, {"count": 1})
        self.assertEqual(self.first.final_outcome, Outcome(1, "again"))
        self.assertEqual(self.first.state_execution_status, StateExecutionStatus.WAIT_FOR_NEXT_STATE)
        stage.native.live[FIRST] = {"active": False}
        self.assertEqual(self.first.state_execution_status, StateExecutionStatus.INACTIVE)
        self.assertFalse(self.first.active or self.first.backward_execution)

    def test_a_run_has_an_id_of_its_own(self):
        first = self.first.run_id
        stage.native.live[FIRST] = {"run_count": 2}
        ids = {first, self.first.run_id, self.root.run_id}
        self.assertEqual(len(ids), 3)
        stage.native.live[FIRST] = {"run_count": 0}
        self.assertIsNone(self.first.run_id)

    def test_what_ran_before(self):
        self.assertIs(self.library.get_previously_executed_state(), self.root)
        self.assertIsNone(self.root.get_previously_executed_state())
        self.assertEqual(len(self.library.execution_history), 0)
        self.assertIsNone(self.library.execution_history.get_last_history_item())
        stage.native.before[LIBRARY] = FIRST
        self.assertIs(self.library.get_previously_executed_state(), self.first)
        self.assertIs(self.library.execution_history.get_last_history_item().state_reference, self.first)

    def test_the_history_of_the_run(self):
        path = self.first.get_path()
        stage.native.happened = [(3, 1.5, path, None, '{"a": 1}', False), (4, 2.0, path, (0, "success"), "{}", False)]
        call, returned = self.root.execution_history
        self.assertEqual((type(call).__name__, type(returned).__name__), ("CallItem", "ReturnItem"))
        self.assertEqual((call.path, call.timestamp, call.outcome, call.call_type.name), (path, 1.5, None, "EXECUTE"))
        self.assertEqual(call.input_output_data, {"a": 1})
        self.assertIs(call.state_reference, self.first)
        self.assertEqual(returned.outcome, Outcome(0, "success"))
        self.assertEqual(self.root.execution_history[-1].sequence, 4)
        engine.replay_from_history(call, None)
        self.assertEqual(stage.native.commands, ["start_from_history 3"])

    def test_a_decider_sees_how_the_others_ended(self):
        error = ZeroDivisionError("division by zero")
        _runtime.set_verdicts(self.decider, [("A", "one", 0, "success", None), ("B", "two", -1, "aborted", error)])
        self.assertEqual(self.decider.get_outcome_for_state_name("one"), Outcome(0, "success"))
        self.assertEqual(self.decider.get_outcome_for_state_id("B").outcome_id, -1)
        self.assertIsNone(self.decider.get_outcome_for_state_name("three"))
        self.assertIs(self.decider.get_errors_for_state_name("two"), error)
        self.assertIsNone(self.decider.get_errors_for_state_name("one"))
        self.assertEqual(list(self.decider.child_errors), ["B"])

    def test_the_engine_takes_commands(self):
        engine.pause()
        engine.start()
        self.assertFalse(engine.finished_or_stopped())
        self.assertEqual(engine.status.execution_mode.name, "STARTED")
        stage.native.doing = "paused"
        self.assertEqual(engine.status.execution_mode.name, "PAUSED")
        engine.stop()
        stage.native.doing = "stopping"
        self.assertTrue(engine.finished_or_stopped())
        self.assertEqual(stage.native.commands, ["pause", "resume", "stop"])

    def test_the_engine_steps(self):
        engine.step_mode()
        engine.step_into()
        engine.step_over()
        engine.step_out()
        engine.backward_step()
        engine.run_to_selected_state("ROOT/FIRST", 1)
        engine.run_selected_state("ROOT/FIRST", 1)
        engine.run_only_selected_state("ROOT/FIRST", 1)
        steps = ["step_mode", "step_into", "step_over", "step_out", "step_back"]
        runs = ["run_to ROOT/FIRST", "run_selected ROOT/FIRST", "run_only_selected ROOT/FIRST"]
        self.assertEqual(stage.native.commands, steps + runs)


class Changes(Stage):
    def check(self, change, *edits):
        stage.native.edits = []
        change()
        self.assertEqual(stage.native.edits, list(edits))

    def test_changes_go_to_the_machine(self):
        root, first = self.root, self.first
        ends = (9, "FIRST", 0, "LIB", None)
        self.check(lambda: root.add_transition(*ends[1:], 9), ("transition.add", "ROOT", ends))
        self.check(lambda: root.set_start_state("LIB"), ("children.start", "ROOT", ("LIB", None)))
        self.check(lambda: first.add_outcome("x", 7), ("outcome.add", first.get_path(), (7, "x")))
        self.check(lambda: setattr(first, "name", "x"), ("state.name", first.get_path(), ("x",)))
        self.check(lambda: setattr(first, "script_text", "x"), ("state.script", first.get_path(), ("x",)))
        rename = ("outcome.rename", first.get_path(), (0, "x"))
        self.check(lambda: setattr(first.outcomes[0], "name", "x"), rename)
        target = ("transition.target", "ROOT", (2, "FIRST", None))
        self.check(lambda: root.transitions[2].modify_target("FIRST"), target)
        self.check(lambda: root.remove_state("FIRST"), ("children.remove", "ROOT", ("FIRST",)))
        self.assertIsNone(first.parent)

    def test_what_belongs_to_other_programs_is_refused(self):
        for call in (
            lambda: state_machine_manager.add_state_machine(None),
            lambda: storage.save_state_machine_to_path(state_machine_manager.get_active_state_machine(), "/tmp"),
            lambda: setattr(self.root.get_state_machine(), "version", "2"),
        ):
            with self.assertRaises(MachineChangeNotSupported) as refused:
                call()
            self.assertIn("Nothing was changed", str(refused.exception))

    def test_what_makes_no_sense_in_a_script_is_refused(self):
        with self.assertRaises(CommandNotSupported):
            engine.set_execution_mode(None)
        with self.assertRaises(CommandNotSupported):
            self.first.execution_history.pop_last_item()


if __name__ == "__main__":
    unittest.main()
