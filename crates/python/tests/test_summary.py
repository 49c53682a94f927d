"""What programs ask of states as a whole, of breakpoints, observers and histories, in machines that they build and run."""

import pathlib
import tempfile
import textwrap
import unittest

from building import call
from support import run, save, script, sequence

TWO = """
root, group = HierarchyState("root", "ROOTID"), HierarchyState("group", "GROUPI")
one, two = ExecutionState("one", "ONEXXX"), ExecutionState("two", "TWOXXX")
for state in (one, two):
    state.script_text = "def execute(self, inputs, outputs, gvm):\\n    print(self.name)\\n    return 0\\n"
root.add_state(group)
group.add_state(one)
root.add_state(two)
root.set_start_state(group)
group.set_start_state(one)
group.add_transition("ONEXXX", 0, "GROUPI", 0)
root.add_transition("GROUPI", 0, "TWOXXX", None)
root.add_transition("TWOXXX", 0, "ROOTID", 0)
machine = StateMachine(root)
state_machine_manager.add_state_machine(machine)
"""


class Built(unittest.TestCase):
    def check(self, program, expected, **environment):
        said = call(TWO + textwrap.dedent(program), **environment)
        self.assertEqual(said, textwrap.dedent(expected).lstrip("\n"))


class Questions(Built):
    def test_numbers_and_paths(self):
        self.check(
            """
            print(root.get_states_statistics(0), one.get_states_statistics(2))
            print(root.get_number_of_transitions(), root.get_number_of_data_flows(), sorted(one.to_dict())[:2])
            print([state.get_storage_path() for state in (root, group, one)])
            print(os.path.basename(one.get_temp_file_system_path()), one.destroy())
            print(state_machine_manager.get_sm_id_for_root_state_id("ROOTID") == machine.state_machine_id)
            """,
            """
            (4, 3) (1, 3)
            5 0 ['description', 'income']
            ['', 'group_GROUPI', 'group_GROUPI/one_ONEXXX']
            one_ONEXXX None
            True
            """,
        )

    def test_a_state_is_waited_for(self):
        self.check(
            """
            import threading
            one.script_text = "def execute(self, inputs, outputs, gvm):\\n    self.preemptive_wait()\\n    return -2\\n"
            one.join()
            engine.start(machine.state_machine_id)
            pause = threading.Event()
            while not one.active:
                pause.wait(0.005)
            waits = threading.Thread(target=one.join)
            waits.start()
            print(waits.is_alive(), one._execution_counter)
            engine.stop()
            waits.join()
            print(one.active)
            engine.join()
            """,
            """
            True 1
            False
            """,
        )

    def test_equal_states_have_equal_hashes(self):
        self.check(
            """
            def made(ports, **named):
                state = ExecutionState("ES", state_id="12345", **named)
                for name, key in ports:
                    state.add_output_data_port(name, "int", data_port_id=key)
                return state.mutable_hash().hexdigest()
            first = made([("a", 1), ("b", 2)])
            print(first == made([("b", 2), ("a", 1)]), first == made([("a", 1)]))
            before = machine.mutable_hash().hexdigest()
            one.script_text += "#"
            print(before == machine.mutable_hash().hexdigest())
            """,
            """
            True False
            False
            """,
        )


class Breakpoints(Built):
    HELD = """
    import threading
    from rafcon.core.execution.execution_status import StateMachineExecutionStatus as Mode
    points = engine.breakpoint_manager
    def until_held():
        pause = threading.Event()
        while engine.status.execution_mode is not Mode.PAUSED:
            pause.wait(0.005)
        print("held")
    """

    def check(self, program, expected):
        Built.check(self, textwrap.dedent(self.HELD) + textwrap.dedent(program), expected)

    def test_a_run_is_held_before_a_state(self):
        self.check(
            """
            points.add_breakpoint(two, "the second")
            engine.start(machine.state_machine_id)
            until_held()
            engine.start()
            engine.join()
            print(root.final_outcome.name)
            """,
            """
            one
            held
            two
            success
            """,
        )

    def test_a_disabled_one_is_passed_and_one_is_set_while_it_is_held(self):
        self.check(
            """
            points.add_breakpoint(group, "group")
            points.add_breakpoint(one, "one")
            points.toggle_breakpoint("one_ONEXXX")
            engine.start(machine.state_machine_id)
            until_held()
            points.add_breakpoint(two, "two")
            points.remove_breakpoint(group)
            engine.start()
            until_held()
            points.clear_all()
            engine.start()
            engine.join()
            """,
            """
            held
            one
            held
            two
            """,
        )

    def test_it_belongs_to_the_name_of_the_folder(self):
        self.check(
            """
            storage.save_state_machine_to_path(machine, OUT + "/machine") if (OUT := os.environ["OUT"]) else None
            library = storage.load_state_machine_from_path(OUT + "/machine").root_state.states["TWOXXX"]
            points.add_breakpoint(library, "two")
            global_config.set_config_value("LIBRARY_PATHS", {"own": OUT})
            root = HierarchyState("root", "OTHERR")
            root.add_state(LibraryState("own", "machine", state_id="LIBXXX"))
            root.set_start_state("LIBXXX")
            root.add_transition("LIBXXX", 0, "OTHERR", 0)
            other = StateMachine(root)
            state_machine_manager.add_state_machine(other)
            engine.start(other.state_machine_id)
            until_held()
            engine.stop()
            engine.join()
            """,
            """
            one
            held
            """,
        )

    def test_the_table(self):
        self.check(
            """
            heard = []
            listener = lambda: heard.append(len(points.get_all_breakpoints()))
            points.add_listener(listener)
            points.add_breakpoint(one, "first")
            points.add_breakpoint(two, "second")
            print(points.get_all_breakpoints()["one_ONEXXX"], points.should_pause(one))
            points.disable_all()
            points.enable_all()
            points.toggle_breakpoint("two_TWOXXX")
            print(points.should_pause(one), points.should_pause(two))
            points.remove_breakpoint_by_id("nothing")
            points.remove_breakpoint(one)
            points.remove_listener(listener)
            points.clear_all()
            print(points.get_all_breakpoints(), heard)
            """,
            """
            {'enabled': True, 'name': 'first', 'display_path': None} True
            True False
            {} [1, 2, 2, 2, 2, 2, 1]
            """,
        )


class Observers(Built):
    def test_of_engine_manager_globals_libraries_and_configuration(self):
        self.check(
            """
            heard = []
            def watch(thing, *names):
                for name in names:
                    thing.add_observer(heard, name, notify_after_function=lambda _thing, _result, args, name=name: (
                        heard.append((name, *map(str, args[1:])))))
            watch(engine, "start", "stop", "pause")
            watch(state_machine_manager, "add_state_machine", "remove_state_machine", "active_state_machine_id")
            watch(gvm, "set_variable", "delete_variable")
            watch(library_manager, "refresh_libraries")
            watch(global_config, "set_config_value")
            gvm.set_variable("a", 1)
            gvm.delete_variable("a")
            library_manager.refresh_libraries()
            global_config.set_config_value("LIBRARY_PATHS", {})
            state_machine_manager.active_state_machine_id = machine.state_machine_id
            engine.start()
            engine.join()
            state_machine_manager.remove_state_machine(machine.state_machine_id)
            print(heard[:4])
            print([name for name, *_arguments in heard[4:]])
            """,
            """
            one
            two
            [('set_variable', 'a', '1'), ('delete_variable', 'a'), ('refresh_libraries',), ('set_config_value', 'LIBRARY_PATHS', '{}')]
            ['active_state_machine_id', 'start', 'remove_state_machine']
            """,
        )


class Containers(Built):
    def test_a_container_in_another_is_called_and_runs_what_is_inside(self):
        self.check(
            """
            engine.start(machine.state_machine_id)
            engine.join()
            for item in machine.execution_histories[0]:
                print(type(item).__name__[0], item.call_type_str, item.path)
            print(len(machine.execution_histories[0]), len({item.history_item_id for item in root.execution_history}))
            """,
            """
            one
            two
            C CONTAINER ROOTID
            C EXECUTE ROOTID/GROUPI
            C CONTAINER ROOTID/GROUPI
            C EXECUTE ROOTID/GROUPI/ONEXXX
            R EXECUTE ROOTID/GROUPI/ONEXXX
            R CONTAINER ROOTID/GROUPI
            R EXECUTE ROOTID/GROUPI
            C EXECUTE ROOTID/TWOXXX
            R EXECUTE ROOTID/TWOXXX
            R CONTAINER ROOTID
            10 10
            """,
        )


class Histories(Built):
    def test_branches_and_decider_stand_in_the_one_list_of_the_last_run(self):
        self.check(
            """
            barrier = BarrierConcurrencyState("barrier", "BARRIE")
            barrier.add_state(root.remove_state("TWOXXX"))
            barrier.states["unique_decider_state_id"].script_text = two.script_text
            barrier.add_transition("unique_decider_state_id", 0, "BARRIE", 0)
            machine.root_state = barrier
            global_config.set_config_value("IN_MEMORY_EXECUTION_HISTORY_ENABLE", False)
            for _ in range(2):
                engine.start(machine.state_machine_id)
                engine.join()
            print(len(machine.execution_histories))
            for item in machine.execution_histories[0]:
                print(type(item).__name__, item.path)
            """,
            """
            two
            Decider
            two
            Decider
            1
            CallItem BARRIE
            CallItem BARRIE/TWOXXX
            ReturnItem BARRIE/TWOXXX
            CallItem BARRIE/unique_decider_state_id
            ReturnItem BARRIE/unique_decider_state_id
            ReturnItem BARRIE
            """,
        )

    def test_a_history_stays_until_the_next_run(self):
        self.check(
            """
            def run():
                engine.start(machine.state_machine_id)
                engine.join()
                return [item.sequence for item in machine.execution_histories[0]]
            first = run()
            machine.clear_execution_histories()
            machine.destroy_execution_histories()
            print(len(first) > 0, [item.sequence for item in machine.execution_histories[0]] == first)
            print(len(run()) == len(first))
            """,
            """
            one
            two
            True True
            one
            two
            True
            """,
        )

    def test_items_say_what_they_are(self):
        text = """
        from rafcon.core.execution.execution_history_items import (
            CallItem, ConcurrencyItem, ReturnItem, ScopedDataItem, StateMachineStartItem
        )
        def execute(self, inputs, outputs, gvm):
            items = list(self.execution_history)
            print([item.call_type_str for item in items], all(isinstance(item, ScopedDataItem) for item in items))
            print(any(isinstance(item, (StateMachineStartItem, ConcurrencyItem)) for item in items))
            print(items[-1].to_dict()["item_type"], items[-1].to_dict()["path"])
            return 0
        """
        with tempfile.TemporaryDirectory() as folder:
            result = run(save(pathlib.Path(folder, "m"), sequence(script(textwrap.dedent(text)))))
        self.assertEqual(
            result.logged("stdout"), ["['CONTAINER', 'EXECUTE'] True", "False", "CallItem R/A"], result.logged()
        )


class Loading(Built):
    def test_faults_of_a_machine_are_in_the_log(self):
        self.check(
            """
            import io, json, logging
            out = os.environ["OUT"]
            storage.save_state_machine_to_path(machine, out + "/m")
            state = json.load(open(out + "/m/core_data.json"))
            for transition in state["transitions"].values():
                transition["from_outcome"] = 7 if transition["from_state"] == "TWOXXX" else transition["from_outcome"]
            json.dump(state, open(out + "/m/core_data.json", "w"))
            said = io.StringIO()
            logging.basicConfig(stream=said, format="%(levelname)s %(message)s")
            storage.load_state_machine_from_path(out + "/m")
            print(said.getvalue().replace(out, "OUT"), end="")
            """,
            """
            ERROR OUT/m: ROOTID, transition 5: it begins at the outcome 7 of TWOXXX, which does not exist; connect the beginning with an outcome that exists, or remove the transition
            """,
        )

    def test_what_the_log_has_of_a_machine_is_not_told_again_when_it_starts(self):
        self.check(
            """
            import json, logging, sys
            out = os.environ["OUT"]
            storage.save_state_machine_to_path(machine, out + "/m")
            state = json.load(open(out + "/m/core_data.json"))
            state["data_flows"] = {"1": {
                "__jsonqualname__": "rafcon.core.state_elements.data_flow.DataFlow", "data_flow_id": 1,
                "from_state": "GROUPI", "from_key": 8, "to_state": "TWOXXX", "to_key": 9,
            }}
            json.dump(state, open(out + "/m/core_data.json", "w"))
            logging.basicConfig(stream=sys.stdout, format="%(levelname)s")
            loaded = StateMachine(storage.load_state_machine_from_path(out + "/m").root_state)
            state_machine_manager.add_state_machine(loaded)
            engine.start(loaded.state_machine_id)
            engine.join()
            """,
            """
            ERROR
            ERROR
            one
            two
            """,
        )


class Libraries(Built):
    def test_a_missing_library_is_seen_by_its_name(self):
        self.check(
            """
            from rafcon.core.custom_exceptions import LibraryNotFoundException
            out = os.environ["OUT"]
            storage.save_state_machine_to_path(machine, out + "/libraries/gone")
            global_config.set_config_value("LIBRARY_PATHS", {"own": out + "/libraries"})
            user = HierarchyState("user", "USERXX")
            user.add_state(LibraryState("own", "gone", name="grasp", state_id="LIBXXX"))
            storage.save_state_machine_to_path(StateMachine(user), out + "/user")
            global_config.set_config_value("LIBRARY_PATHS", {})
            loaded = storage.load_state_machine_from_path(out + "/user")
            state = loaded.root_state.states["LIBXXX"]
            print(state.name == storage.LIBRARY_NOT_FOUND_DUMMY_STATE_NAME, state.is_dummy, state.library_name)
            storage.save_state_machine_to_path(loaded, out + "/again")
            global_config.set_config_value("LIBRARY_PATHS", {"own": out + "/libraries"})
            state = storage.load_state_machine_from_path(out + "/again").root_state.states["LIBXXX"]
            print(state.name, state.is_dummy)
            global_config.set_config_value("LIBRARY_PATHS", {})
            global_config.set_config_value("RAISE_ERROR_ON_MISSING_LIBRARY_STATES", True)
            try:
                storage.load_state_machine_from_path(out + "/user")
            except LibraryNotFoundException as error:
                print(error)
            """,
            """
            True True gone
            grasp False
            the library `own/gone` of the state USERXX/LIBXXX is missing
            """,
        )

    def test_the_usual_roots_are_below_rafcon_lib_path(self):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "generic").mkdir()
            self.check("print(list(library_manager.library_root_paths))", "['generic']\n", RAFCON_LIB_PATH=folder)


if __name__ == "__main__":
    unittest.main()
