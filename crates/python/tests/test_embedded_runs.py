"""What programs see of the runs of their machines: data, modes, inputs, journals, what a start costs."""

import textwrap
import unittest

from building import call

#: A hierarchy of scripts, one after the other, by name and text; `inner` puts them into a hierarchy inside.
ROW = '''
def script(name, text):
    state = ExecutionState(name, name.upper())
    state.script_text = "def execute(self, inputs, outputs, gvm):\\n    " + text + "\\n"
    return state

def row(container, *states):
    for state in states:
        container.add_state(state)
    container.set_start_state(states[0])
    for state, following in zip(states, states[1:]):
        container.add_transition(state.state_id, 0, following.state_id, None)
    container.add_transition(states[-1].state_id, 0, container.state_id, 0)
    return container

def known(root):
    machine = StateMachine(root)
    state_machine_manager.add_state_machine(machine)
    return machine

def run(machine, **wanted):
    engine.start(machine.state_machine_id, **wanted)
    engine.join()

def wait_for(count):
    while engine.synchronization_counter < count:
        pass
'''

#: A root with the input x, and in it a hierarchy with the input x and the output y, ten times x.
DATA = '''
def data(after="return 0"):
    inner = row(HierarchyState("inner", "INNER"), script("ten", "outputs['y'] = inputs['x'] * 10; return 0"))
    root = row(HierarchyState("root", "ROOT"), inner, script("after", after))
    for state in (inner, inner.states["TEN"]):
        state.add_input_data_port("x", int, 1, 0)
        state.add_output_data_port("y", int, None, 1)
    root.add_input_data_port("x", int, 7, 0)
    root.add_scoped_variable("kept", int, 3, 5)
    inner.add_scoped_variable("inside", int, 4, 6)
    root.add_data_flow("ROOT", 0, "INNER", 0)
    inner.add_data_flow("INNER", 0, "TEN", 0)
    inner.add_data_flow("TEN", 1, "INNER", 1)
    return known(root)
'''


class EmbeddedRuns(unittest.TestCase):
    def check(self, program, expected):
        given = call(ROW + DATA + textwrap.dedent(program))
        self.assertEqual(given, textwrap.dedent(expected).lstrip("\n"))

    def test_a_machine_whose_root_is_damaged_is_not_run(self):
        self.check(
            """
            import pathlib
            machine = data()
            storage.save_state_machine_to_path(machine, "m")
            state_machine_manager.remove_state_machine(machine.state_machine_id)
            pathlib.Path("m/core_data.json").write_text("{")
            damaged = storage.load_state_machine_from_path("m")
            state_machine_manager.add_state_machine(damaged)
            refused(run, damaged)
            """,
            """
            RuntimeError
            """,
        )

    # ---- data

    def test_a_script_reads_the_data_of_a_hierarchy_that_has_ended(self):
        self.check(
            """
            after = "inner = self.parent.states['INNER']; print(inner.input_data, inner.output_data); return 0"
            run(data(after))
            """,
            """
            {'x': 7} {'y': 70}
            """,
        )

    def test_a_program_reads_the_data_of_all_that_has_ended(self):
        self.check(
            """
            machine = data()
            run(machine)
            root = machine.root_state
            inner = root.states["INNER"]
            print(root.input_data, inner.input_data, inner.output_data, inner.states["TEN"].output_data)
            """,
            """
            {'x': 7} {'x': 7} {'y': 70} {'y': 70}
            """,
        )

    def test_concurrency_and_library_states_have_their_data_too(self):
        self.check(
            """
            ten = script("ten", "outputs['y'] = inputs['x'] * 10; return 0")
            library = row(HierarchyState("lib", "LIB"), ten)
            both = PreemptiveConcurrencyState("both", "BOTH")
            both.add_state(library)
            both.add_transition("LIB", 0, "BOTH", 0)
            for state in (both, library, ten):
                state.add_input_data_port("x", int, 2, 0)
                state.add_output_data_port("y", int, None, 1)
            library.add_data_flow("LIB", 0, "TEN", 0)
            library.add_data_flow("TEN", 1, "LIB", 1)
            both.add_data_flow("BOTH", 0, "LIB", 0)
            both.add_data_flow("LIB", 1, "BOTH", 1)
            storage.save_state_machine_to_path(StateMachine(both), "libs/both")
            global_config.set_config_value("LIBRARY_PATHS", {"libs": "libs"})
            library_manager.initialize()
            state = LibraryState("libs", "both", state_id="STATE")
            after = "lib = self.parent.states['STATE']; print(lib.input_data, lib.output_data, lib.state_copy.output_data); return 0"
            run(known(row(HierarchyState("root", "ROOT"), state, script("after", after))))
            print(state.output_data, state.state_copy.states["LIB"].output_data)
            """,
            """
            {'x': 2} {'y': 20} {'y': 20}
            {'y': 20} {'y': 20}
            """,
        )

    def test_a_hierarchy_that_failed_has_its_error(self):
        self.check(
            """
            inner = row(HierarchyState("inner", "INNER"), script("bad", "raise ValueError('no')"))
            run(known(row(HierarchyState("root", "ROOT"), inner)))
            print(repr(inner.output_data["error"]), inner.final_outcome.name)
            """,
            """
            ValueError('no') aborted
            """,
        )

    def test_scoped_data_has_inputs_variables_and_outputs_of_those_inside(self):
        self.check(
            """
            show = "print({key: data.value for key, data in sorted(self.parent.scoped_data.items())}); return 0"
            machine = data(show)
            run(machine)
            inner = machine.root_state.states["INNER"]
            print({key: (data.name, data.value, data.from_state) for key, data in sorted(inner.scoped_data.items())})
            """,
            """
            {'0ROOT': 7, '1INNER': 70, '5ROOT': 3}
            {'0INNER': ('x', 7, 'INNER'), '1TEN': ('y', 70, 'TEN'), '6INNER': ('inside', 4, 'INNER')}
            """,
        )

    def test_scoped_data_says_of_which_class_a_port_is(self):
        self.check(
            """
            machine = data()
            run(machine)
            inner = machine.root_state.states["INNER"]
            print([inner.scoped_data[key].data_port_type.__name__ for key in ("0INNER", "1TEN", "6INNER")])
            """,
            """
            ['InputDataPort', 'OutputDataPort', 'ScopedVariable']
            """,
        )

    def test_outputs_that_are_assigned_stand_there_until_the_run(self):
        self.check(
            """
            machine = data()
            inner = machine.root_state.states["INNER"]
            print(inner.output_data)
            inner.output_data = {"y": None}
            print(inner.output_data)
            run(machine)
            print(inner.output_data)
            refused(setattr, inner, "output_data", 7)
            """,
            """
            {}
            {'y': None}
            {'y': 70}
            TypeError
            """,
        )

    # ---- inputs and global variables

    def test_a_start_takes_inputs_and_global_variables(self):
        self.check(
            """
            machine = data("print(gvm.get_variable('word')); return 0")
            inner = machine.root_state.states["INNER"]
            gvm.set_variable("word", "hello")
            run(machine, inputs={"x": 4})
            print(inner.output_data)
            machine.root_state.input_data = {"x": 5}
            print(machine.root_state.input_data)
            run(machine)
            print(inner.output_data)
            refused(setattr, machine.root_state, "input_data", 3)
            """,
            """
            hello
            {'y': 40}
            {'x': 4}
            hello
            {'y': 50}
            TypeError
            """,
        )

    # ---- the manager

    def test_the_manager_is_empty_when_all_is_removed(self):
        self.check(
            """
            machine = data()
            run(machine)
            print(state_machine_manager.active_state_machine_id, state_machine_manager.get_active_state_machine())
            state_machine_manager.delete_all_state_machines()
            print(state_machine_manager.state_machines)
            other = data()
            run(other)
            state_machine_manager.remove_state_machine(other.state_machine_id)
            print(state_machine_manager.state_machines, state_machine_manager.get_active_state_machine())
            """,
            """
            None None
            {}
            {} None
            """,
        )

    # ---- stopping

    def test_a_stop_where_nothing_runs_does_nothing(self):
        self.check(
            """
            engine.stop()
            machine = data()
            run(machine)
            engine.stop()
            print(machine.root_state.final_outcome.name, engine.status.execution_mode.name)
            """,
            """
            success FINISHED
            """,
        )

    # ---- stepping

    def test_the_mode_says_which_step_was_asked_for(self):
        self.check(
            """
            machine = data()
            root, key = machine.root_state, machine.state_machine_id
            inner, after = root.states["INNER"], root.states["AFTER"]
            def show(count):
                wait_for(count)
                states = [root, inner, inner.states["TEN"], after]
                print(engine.status.execution_mode.name, *[state.state_execution_status.name for state in states])
            engine.step_mode(key)
            show(1)
            engine.step_into()
            show(2)
            engine.step_over()
            show(3)
            engine.backward_step()
            show(4)
            engine.run_to_selected_state("ROOT/AFTER")
            show(5)
            engine.step_out()
            engine.join()
            print(engine.status.execution_mode.name, root.state_execution_status.name)
            """,
            """
            STEP_MODE WAIT_FOR_NEXT_STATE INACTIVE INACTIVE INACTIVE
            FORWARD_INTO EXECUTE_CHILDREN WAIT_FOR_NEXT_STATE INACTIVE INACTIVE
            FORWARD_OVER EXECUTE_CHILDREN WAIT_FOR_NEXT_STATE INACTIVE INACTIVE
            BACKWARD EXECUTE_CHILDREN WAIT_FOR_NEXT_STATE INACTIVE INACTIVE
            RUN_TO_SELECTED_STATE EXECUTE_CHILDREN WAIT_FOR_NEXT_STATE INACTIVE INACTIVE
            FINISHED INACTIVE
            """,
        )

    def test_the_counter_of_holds_may_be_set_back(self):
        self.check(
            """
            machine = data()
            engine.step_mode(machine.state_machine_id)
            for _ in range(2):
                wait_for(1)
                engine.synchronization_counter = 0
                engine.step_into()
            # The second step ends at a hold, so the machine cannot have finished.
            engine.start()
            print(engine.join(), engine.finished_or_stopped())
            """,
            """
            True True
            """,
        )

    # ---- files

    def test_a_command_for_a_run_that_ends_in_this_moment_begins_another(self):
        self.check(
            """
            states = [script("one", "print('one'); return 0"), script("two", "print('two'); return 0")]
            machine = known(row(HierarchyState("root", "ROOT"), *states))
            run(machine)
            is_running = engine._is_running

            def it_ends_now():
                engine._is_running = is_running
                return True

            engine._is_running = it_ends_now
            run(machine)
            engine._is_running = it_ends_now
            engine.step_mode(machine.state_machine_id)
            run(machine)
            engine._is_running = it_ends_now
            engine.run_to_selected_state("ROOT/TWO", machine.state_machine_id)
            wait_for(2)
            print("held")
            run(machine)
            """,
            """
            one
            two
            one
            two
            one
            two
            one
            held
            two
            """,
        )

    def test_a_machine_that_is_started_for_one_state_is_held_once(self):
        self.check(
            """
            commands = ((engine.run_selected_state, "ROOT/INNER"), (engine.run_to_selected_state, "ROOT/AFTER"))
            for command, path in commands:
                machine = data()
                engine.synchronization_counter = 0
                command(path, machine.state_machine_id)
                wait_for(1)
                engine.stop()
                engine.join()
                print(machine.root_state.states["INNER"].output_data, engine.synchronization_counter)
            """,
            """
            {'y': 70} 1
            {'y': 70} 1
            """,
        )

    def test_a_start_writes_no_file(self):
        self.check(
            """
            def files():
                return sorted(os.path.join(folder, name) for folder, _, names in os.walk(os.environ["TMPDIR"]) for name in names)
            os.environ["TMPDIR"] = os.path.join(os.environ["OUT"], "tmp")
            os.mkdir(os.environ["TMPDIR"])
            before = files()
            machine = data("import os; print(len([1 for _, _, names in os.walk(os.environ['TMPDIR']) for name in names])); return 0")
            run(machine)
            print(files() == before, machine.file_system_path)
            """,
            """
            0
            True None
            """,
        )

    def test_what_runs_is_what_stands_in_memory(self):
        self.check(
            """
            machine = data("print('saved', self.file_system_path is not None); return 0")
            storage.save_state_machine_to_path(machine, "m")
            run(machine)
            machine.root_state.states["AFTER"].script_text = "def execute(self, inputs, outputs, gvm):\\n    raise ValueError('changed')"
            import logging, sys
            logging.basicConfig(stream=sys.stdout, level=logging.ERROR, format="%(message)s")
            other = known(row(HierarchyState("r", "R"), script("bad", "raise KeyError('unsaved')")))
            run(other)
            print(repr(other.root_state.output_data["error"]))
            """,
            """
            saved True
            Traceback (most recent call last):
              File "<R/BAD/script.py>", line 2, in execute
                raise KeyError('unsaved')
            KeyError: 'unsaved'
            KeyError('unsaved')
            """,
        )

    # ---- journals

    def test_a_run_keeps_a_journal_if_wanted(self):
        self.check(
            """
            machine = data()
            run(machine)
            print(engine.run_folder)
            run(machine, journal="runs")
            print(os.path.dirname(engine.run_folder) == os.path.abspath("runs"), os.path.isfile(engine.run_folder + "/run.json"))
            run(machine, journal=True)
            print(os.path.relpath(os.path.dirname(engine.run_folder), os.environ["HOME"]))
            global_config.set_config_value("FILE_SYSTEM_EXECUTION_HISTORY_ENABLE", True)
            run(machine)
            print(engine.run_folder is not None)
            """,
            """
            None
            True True
            .local/state/rafcon/runs
            True
            """,
        )

    def test_the_command_line_finds_it_with_values_and_global_variables(self):
        self.check(
            """
            import json, subprocess
            gvm.set_variable("word", "hello")
            machine = data("gvm.set_variable('more', [1, 2]); return 0")
            run(machine, journal=True)
            def rafcon(*words):
                ended = subprocess.run([os.environ["RAFCON_BINARY"], *words], capture_output=True, text=True)
                assert ended.returncode == 0, ended.stderr
                return ended.stdout
            print(os.path.basename(engine.run_folder) in rafcon("runs"))
            print(json.loads(rafcon("replay", "last", "--json"))["globals"])
            left = [json.loads(line) for line in rafcon("history", "last", "--values", "--json").splitlines()]
            print([entry["event"]["outputs"] for entry in left if entry["event"].get("path") == "ROOT/INNER" and "outputs" in entry["event"]])
            """,
            """
            True
            {'more': [1, 2], 'word': 'hello'}
            [{'y': 70}]
            """,
        )

    def test_a_run_that_has_ended_begins_again_at_an_entry_of_its_history(self):
        self.check(
            """
            machine = data("print('after', self.parent.states['INNER'].output_data, gvm.get_variable('n')); gvm.set_variable('n', 2); return 0")
            gvm.set_variable("n", 1)
            run(machine, journal=True)
            history = machine.root_state.execution_history
            item = next(item for item in history if item.path == "ROOT/AFTER")
            engine.replay_from_history(item)
            print(engine.status.execution_mode.name)
            engine.start()
            print(engine.join(), machine.root_state.final_outcome.name)
            run(machine)
            refused(engine.replay_from_history, item)
            """,
            """
            after {'y': 70} 1
            RUN_TO_SELECTED_STATE
            after {} 1
            True success
            after {'y': 70} 2
            RuntimeError
            """,
        )


if __name__ == "__main__":
    unittest.main()
