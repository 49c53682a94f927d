"""Library states in programs: their names, and values of their own instead of the defaults of the library."""

import textwrap
import unittest

from building import call

LIBRARY = '''
def library(name="Go to"):
    root = HierarchyState(name, "GOTOID")
    root.add_input_data_port("where", str, "home", 0)
    root.add_input_data_port("speed", int, 3, 1)
    root.add_output_data_port("took", int, 4, 2)
    say = ExecutionState("say", "SAYXXX")
    say.script_text = "def execute(self, inputs, outputs, gvm):\\n    print(self.parent.input_data)\\n    return 0\\n"
    root.add_state(say)
    root.set_start_state(say)
    root.add_transition("SAYXXX", 0, "GOTOID", 0)
    storage.save_state_machine_to_path(StateMachine(root), "libs/go_to")
    global_config.set_config_value("LIBRARY_PATHS", {"libs": "libs"})
    library_manager.initialize()
    return LibraryState("libs", "go_to")

def saved(state):
    root = HierarchyState("root", "ROOTID")
    root.add_state(state)
    root.set_start_state(state)
    root.add_transition(state.state_id, 0, "ROOTID", 0)
    machine = StateMachine(root)
    storage.save_state_machine_to_path(machine, "m")
    return storage.load_state_machine_from_path("m").root_state.states[state.state_id]

def run(state):
    machine = StateMachine(state.parent)
    state_machine_manager.add_state_machine(machine)
    engine.start(machine.state_machine_id)
    engine.join()
'''


class Libraries(unittest.TestCase):
    def check(self, program, expected):
        self.assertEqual(call(LIBRARY + textwrap.dedent(program)), textwrap.dedent(expected).lstrip("\n"))

    def test_a_state_without_a_name_is_called_after_the_library(self):
        self.check(
            """
            print(library().name, LibraryState("libs", "go_to", name="there").name)
            """,
            """
            Go to there
            """,
        )

    def test_a_library_state_has_no_version_of_its_own(self):
        self.check(
            """
            print(library().version, library_manager.get_library_instance("libs", "go_to").version)
            """,
            """
            None None
            """,
        )

    def test_own_values_change_in_place_and_are_saved(self):
        self.check(
            """
            state = library()
            state.input_data_port_runtime_values[0] = "Alice"
            state.output_data_port_runtime_values.update({2: 5})
            state.use_runtime_value_output_data_ports[2] = False
            found = saved(state)
            print(found.input_data_port_runtime_values, found.output_data_port_runtime_values)
            print(found.use_runtime_value_input_data_ports, found.use_runtime_value_output_data_ports)
            """,
            """
            {0: 'Alice', 1: 3} {2: 5}
            {0: True, 1: True} {2: False}
            """,
        )

    def test_a_port_that_the_file_does_not_list_has_the_default_of_the_library(self):
        self.check(
            """
            state = library()
            saved(state)
            import json, glob
            (path,) = [path for path in glob.glob("m/*/core_data.json") if "library_name" in open(path).read()]
            core = json.load(open(path))
            names = [name for name in core if "runtime_value" in name]
            core.update((name, {}) for name in names)
            json.dump(core, open(path, "w"))
            found = storage.load_state_machine_from_path("m").root_state.states[state.state_id]
            print(len(names), found.input_data_port_runtime_values, found.output_data_port_runtime_values)
            print(found.use_runtime_value_input_data_ports, found.use_runtime_value_output_data_ports)
            values = found.input_data_port_runtime_values
            values[1] = 5
            print(values, found.use_runtime_value_input_data_ports[1])
            run(found)
            """,
            """
            4 {0: 'home', 1: 3} {2: 4}
            {0: True, 1: True} {2: True}
            {0: 'home', 1: 5} True
            {'where': 'home', 'speed': 5}
            """,
        )

    def test_own_values_change_after_the_state_was_added_and_count_in_the_run(self):
        self.check(
            """
            state = library()
            saved(state)
            state.input_data_port_runtime_values[0] = "Bob"
            state.input_data_port_runtime_values = {1: "9"}
            print(state.input_data_port_runtime_values)
            run(state)
            state.use_runtime_value_input_data_ports = {0: False}
            run(state)
            """,
            """
            {0: 'Bob', 1: 9}
            {'where': 'Bob', 'speed': 9}
            {'where': 'home', 'speed': 9}
            """,
        )

    def test_own_values_are_no_matter_for_the_log(self):
        self.check(
            """
            import logging, sys
            logging.basicConfig(stream=sys.stdout, level=logging.INFO, format="%(levelname)s %(message)s")
            state = library()
            state.set_input_runtime_value(0, "Alice")
            state.input_data_port_runtime_values = {1: 7}
            state.set_use_input_runtime_value(1, False)
            state.set_output_runtime_value(2, 5)
            state.set_use_output_runtime_value(2, False)
            found = saved(state)
            print(found.input_data_port_runtime_values, found.use_runtime_value_input_data_ports)
            print(found.output_data_port_runtime_values, found.use_runtime_value_output_data_ports)
            run(found)
            """,
            """
            {0: 'Alice', 1: 7} {0: True, 1: False}
            {2: 5} {2: False}
            {'where': 'Alice', 'speed': 3}
            """,
        )

    def test_a_value_of_a_port_that_is_gone_is_logged_once(self):
        self.check(
            """
            import glob, json, logging, sys
            saved(library())
            [file] = glob.glob("m/*/core_data.json")
            with open(file) as text:
                state = json.load(text)
            state["input_data_port_runtime_values"]["7"] = 1
            with open(file, "w") as text:
                json.dump(state, text)
            logging.basicConfig(stream=sys.stdout, level=logging.INFO, format="%(levelname)s")
            storage.load_state_machine_from_path("m")
            """,
            """
            ERROR
            """,
        )

    def test_wrong_own_values_are_refused(self):
        self.check(
            """
            state = library()
            refused(state.input_data_port_runtime_values.__setitem__, 7, "x")
            refused(state.input_data_port_runtime_values.__setitem__, 1, "fast")
            refused(state.input_data_port_runtime_values.pop, 1)
            refused(setattr, state, "input_data_port_runtime_values", 3)
            print(state.input_data_port_runtime_values)
            """,
            """
            KeyError
            AttributeError
            TypeError
            TypeError
            {0: 'home', 1: 3}
            """,
        )

    def test_a_default_that_a_port_gets_is_the_states_own_value(self):
        self.check(
            """
            state = library()
            state.input_data_ports[1].default_value = 8
            print(state.input_data_ports[1].default_value, state.state_copy.input_data_ports[1].default_value)
            print(saved(state).input_data_port_runtime_values)
            run(state)
            """,
            """
            8 3
            {0: 'home', 1: 8}
            {'where': 'home', 'speed': 8}
            """,
        )


if __name__ == "__main__":
    unittest.main()
