"""States that are used in more than one place, states that are compared, and classes that are made by themselves."""

import textwrap
import unittest

from building import call


class TakingOver(unittest.TestCase):
    def check(self, program, expected):
        self.assertEqual(call(textwrap.dedent(program)), textwrap.dedent(expected).lstrip("\n"))

    def test_a_root_is_taken_over_by_another_machine_and_a_copy_stays(self):
        self.check(
            """
            root = HierarchyState("root", "ROOTID")
            inside = ExecutionState("inside", "INSIDE")
            root.add_state(inside)
            first = StateMachine(root)
            storage.save_state_machine_to_path(first, "first")
            second = StateMachine(first.root_state)
            print(root.parent is second, inside.get_state_machine() is second, second.file_system_path)
            root.name = "other"
            storage.save_state_machine_to_path(second, "second")
            print(first.root_state.name, list(first.root_state.states), os.path.basename(first.file_system_path))
            names = [storage.load_state_machine_from_path(path).root_state.name for path in ("first", "second")]
            print(names, first.root_state.parent is first)
            """,
            """
            True True None
            root ['INSIDE'] first
            ['root', 'other'] True
            """,
        )

    def test_one_state_is_the_root_of_several_saved_machines(self):
        self.check(
            """
            state = ExecutionState("state", "STATEX")
            for number in range(3):
                state.name = f"state {number}"
                storage.save_state_machine_to_path(StateMachine(state), f"m{number}")
            print([storage.load_state_machine_from_path(f"m{number}").root_state.name for number in range(3)])
            """,
            """
            ['state 0', 'state 1', 'state 2']
            """,
        )

    def test_a_state_that_stands_elsewhere_moves_and_a_copy_stays(self):
        self.check(
            """
            here, there = HierarchyState("here", "HEREXX"), HierarchyState("there", "THEREX")
            state = ExecutionState("state", "STATEX")
            here.add_state(state)
            here.set_start_state(state)
            there.add_state(state)
            state.name = "moved"
            print(state.parent is there, here.states["STATEX"].name, here.start_state_id, here.states["STATEX"].parent is here)
            print(there.add_state(state) == state.state_id != "STATEX", there.states["STATEX"].name, len(there.states))
            """,
            """
            True state STATEX True
            True moved 2
            """,
        )

    def test_a_state_cannot_stand_in_itself(self):
        self.check(
            """
            outer, inner = HierarchyState("outer", "OUTERX"), HierarchyState("inner", "INNERX")
            outer.add_state(inner)
            refused(inner.add_state, outer)
            refused(outer.add_state, outer)
            print(list(outer.states), inner.parent is outer)
            """,
            """
            ValueError
            ValueError
            ['INNERX'] True
            """,
        )

    def test_a_decider_of_ones_own_needs_no_id(self):
        self.check(
            """
            decider = DeciderState("Judge")
            barrier = BarrierConcurrencyState("B", decider_state=decider)
            print(decider.state_id, [state.name for state in barrier.states.values()])
            """,
            """
            unique_decider_state_id ['Judge']
            """,
        )

    def test_states_with_the_same_content_are_equal(self):
        self.check(
            """
            import copy
            state = ExecutionState("a", "AXXXXX")
            twin = copy.copy(state)
            print(twin == state, twin is state, state == ExecutionState("b", "BXXXXX"), state != 3, len({state, twin}))
            twin.add_outcome("more")
            print(twin == state)
            """,
            """
            True False False True 2
            False
            """,
        )

    def test_classes_by_themselves_and_ids_of_other_types(self):
        self.check(
            """
            from copy import copy
            from rafcon.core.states.container_state import ContainerState
            from rafcon.core.states.concurrency_state import ConcurrencyState
            container = ContainerState("c", 1)
            container.add_state(ExecutionState("e", 7))
            print(container.state_id, list(container.states), container.name, copy(container) == container)
            refused(ConcurrencyState, "c")
            refused(container.add_data_flow, "7", "out", "1", "in")
            container.add_transition(7, 0, 1, 0)
            print([(line.from_state, line.to_state) for line in container.transitions.values()])
            refused(container.add_transition, 8, 0, 1, 0)
            refused(container.add_data_flow, 8, 0, 7, 0)
            """,
            """
            1 ['7'] c True
            TypeError
            ValueError
            [('7', '1')]
            ValueError
            ValueError
            """,
        )

    def test_calls_that_hold_the_lock_of_a_machine_are_counted(self):
        self.check(
            """
            from rafcon.core import decorators
            from rafcon.core.state_machine_manager import StateMachineManager
            root = ExecutionState("root")
            machine = StateMachine(root)
            @decorators.lock_state_machine
            def failing(state):
                print(decorators.global_lock_counter)
                raise AttributeError("no")
            refused(failing, root)
            print(decorators.global_lock_counter)
            print(StateMachineManager.instance([machine]) is state_machine_manager, state_machine_manager.state_machines)
            """,
            """
            1
            AttributeError
            0
            True {}
            """,
        )

    def test_a_state_becomes_a_dictionary_and_another_state(self):
        self.check(
            """
            leaf = ExecutionState("leaf", "LEAFID")
            leaf.description = "What it is."
            key = leaf.add_input_data_port("x", int, 3)
            port = leaf.input_data_ports[key]
            leaf.add_outcome("other", 1)
            made = ExecutionState.from_dict(ExecutionState.state_to_dict(leaf))
            print(made == leaf, made is leaf, made.description, port.parent is leaf)
            made.input_data_ports[key].name = "y"
            print(port.name, [port.name for port in made.input_data_ports.values()])
            group = HierarchyState("group", "GROUPI")
            group.add_scoped_variable("kept", int, 7)
            group.add_state(leaf)
            group.add_transition("LEAFID", 0, "GROUPI", 0)
            made, transitions, data_flows = HierarchyState.from_dict(group.to_dict())
            print(made.name, [kept.default_value for kept in made.scoped_variables.values()], len(made.states))
            print(transitions == group.transitions, data_flows)
            """,
            """
            True False What it is. True
            x ['y']
            group [7] 0
            True {}
            """,
        )

    def test_a_configuration_that_nobody_named_may_be_missing(self):
        self.check(
            """
            import logging, sys
            logging.basicConfig(stream=sys.stdout, level=logging.INFO, format="%(levelname)s")
            global_config.load()
            print("between")
            global_config.load(path="nowhere")
            global_config.load("none.yaml")
            """,
            """
            between
            INFO
            WARNING
            """,
        )


if __name__ == "__main__":
    unittest.main()
