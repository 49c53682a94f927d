"""Programs that run the machines that they have built, in their own process."""

import textwrap
import unittest

from building import called

#: A machine of one state whose script is given.
ONE = '''
def one(text, **ports):
    state = ExecutionState("one", "ONEXXX")
    state.script_text = "def execute(self, inputs, outputs, gvm):\\n    " + text + "\\n"
    root = HierarchyState("root", "ROOTID")
    root.add_state(state)
    root.set_start_state(state)
    root.add_transition("ONEXXX", 0, "ROOTID", 0)
    machine = StateMachine(root)
    state_machine_manager.add_state_machine(machine)
    return machine
'''


class Embedding(unittest.TestCase):
    def check(self, program, expected):
        printed, errors = called(ONE + textwrap.dedent(program))
        self.assertEqual(printed, textwrap.dedent(expected).lstrip("\n"), errors)

    def test_a_machine_runs_where_it_was_built(self):
        self.check(
            """
            machine = one("gvm.set_variable('seen', gvm.get_variable('word') + [os], per_reference=True); return 0")
            machine.root_state.states["ONEXXX"].script_text = "import os\\n" + machine.root_state.states["ONEXXX"].script_text
            gvm.set_variable("word", [1])
            engine.start(machine.state_machine_id)
            print(engine.join(), machine.root_state.final_outcome.name, gvm.get_variable("seen")[1] is os)
            print(engine.finished_or_stopped(), machine.root_state.states["ONEXXX"].final_outcome.outcome_id)
            """,
            """
            True success True
            True 0
            """,
        )

    def test_outputs_are_the_objects_themselves(self):
        self.check(
            """
            machine = one("outputs['found'] = {1, 2}; return 0")
            root, state = machine.root_state, machine.root_state.states["ONEXXX"]
            state.add_output_data_port("found", set)
            root.add_output_data_port("found", object)
            root.add_data_flow("ONEXXX", 0, "ROOTID", 0)
            machine.start()
            machine.join()
            print(root.output_data, state.output_data)
            """,
            """
            {'found': {1, 2}} {'found': {1, 2}}
            """,
        )

    def test_one_run_after_the_other(self):
        self.check(
            """
            first, second = one("return 0"), one("raise ValueError('no')")
            for machine in (first, second, first):
                engine.start(machine.state_machine_id)
                engine.join()
                root = machine.root_state
                print(root.final_outcome.name, repr(root.output_data.get("error")))
            print(second.root_state.final_outcome.name)
            """,
            """
            success None
            aborted ValueError('no')
            success None
            aborted
            """,
        )

    def test_the_usual_calls_open_and_run(self):
        self.check(
            """
            from rafcon.core import start
            machine = one("return 0")
            storage.save_state_machine_to_path(machine, "m")
            state_machine_manager.delete_all_state_machines()
            os.mkdir("config")
            with open("config/config.yaml", "w") as file:
                file.write("LIBRARY_PATHS: {lib: .}")
            start.setup_configuration("config")
            print(library_manager.library_root_paths == {"lib": os.path.realpath("config")})
            opened = start.open_state_machine("m")
            start.start_state_machine(opened)
            start.wait_for_state_machine_finished(opened)
            print(opened.root_state.final_outcome.name)
            """,
            """
            True
            success
            """,
        )

    def test_what_scripts_log_goes_where_the_program_wants(self):
        self.check(
            """
            import logging, sys
            logging.basicConfig(stream=sys.stdout, level=logging.INFO, format="%(name)s %(levelname)s %(message).29s")
            machine = one("self.logger.info('hello'); print('plain'); return 'nowhere'")
            machine.start()
            machine.join()
            """,
            """
            rafcon.one INFO hello
            plain
            rafcon.engine ERROR the script returned 'nowhere'
            """,
        )

    def test_it_can_be_stopped_and_paused(self):
        self.check(
            """
            machine = one("self.preemptive_wait(); return 0")
            engine.start(machine.state_machine_id)
            print(engine.join(0.01))
            engine.pause()
            print(engine.status.execution_mode.name)
            engine.start()
            engine.stop()
            print(engine.join(), machine.root_state.final_outcome.name, engine.join(0))
            """,
            """
            False
            PAUSED
            True preempted True
            """,
        )

    def test_a_script_may_fork(self):
        self.check(
            """
            text = "child = os.fork(); outputs['code'] = os.waitpid(child, 0)[1] if child else None; return 0"
            machine = one(text)
            state = machine.root_state.states["ONEXXX"]
            state.script_text = "import os\\n" + state.script_text
            state.add_output_data_port("code", object)
            for _ in range(2):
                machine.start()
                print(engine.join(), state.output_data)
            """,
            """
            True {'code': 0}
            True {'code': 0}
            """,
        )

    def test_ctrl_c_ends_the_wait_and_the_machine(self):
        self.check(
            """
            import signal

            # Whoever starts the tests in the background has it ignored.
            signal.signal(signal.SIGINT, signal.default_int_handler)
            machine = one("os.kill(os.getpid(), signal.SIGINT); self.preemptive_wait(); return 0")
            state = machine.root_state.states["ONEXXX"]
            state.script_text = "import os, signal\\n" + state.script_text
            try:
                machine.start()
                engine.join()
                engine.join(30)
            except KeyboardInterrupt:
                print("interrupted")
            print(engine.join(), machine.root_state.final_outcome.name)
            """,
            """
            interrupted
            True preempted
            """,
        )

    def test_a_start_that_is_interrupted_leaves_a_run_that_can_be_waited_for(self):
        self.check(
            """
            import threading

            start_thread = threading.Thread.start

            def interrupted(thread):
                start_thread(thread)
                if thread.name == "rafcon run":
                    raise KeyboardInterrupt

            threading.Thread.start = interrupted
            machine = one("return 0")
            try:
                machine.start()
            except KeyboardInterrupt:
                print("interrupted")
            print(engine.join(), machine.root_state.final_outcome.name)
            """,
            """
            interrupted
            True success
            """,
        )

    def test_it_can_be_stepped(self):
        self.check(
            """
            machine = one("print('one'); return 0")
            engine.step_mode(machine.state_machine_id)
            print(engine.join(0.01), engine.state_machine_running)
            engine.step_into()
            print(engine.join(), machine.root_state.final_outcome.name)
            engine.step_mode(machine.state_machine_id)
            engine.start()
            print(engine.join(), machine.root_state.final_outcome.name)
            engine.run_only_selected_state("ROOTID/ONEXXX", machine.state_machine_id)
            print(engine.join())
            """,
            """
            False True
            one
            True success
            one
            True success
            one
            True
            """,
        )

    def test_a_machine_that_cannot_start_says_why(self):
        self.check(
            """
            machine = one("return 0")
            try:
                engine.start(machine.state_machine_id, "ROOTID/NOPE")
            except RuntimeError as error:
                print(str(error).partition(": 'NOPE'")[0])
            refused(engine.start, 99)
            print(engine.join())
            """,
            """
            the state machine cannot be run: there is no state at 'ROOTID/NOPE'
            AttributeError
            False
            """,
        )

    def test_a_loaded_machine_runs_from_its_folder(self):
        self.check(
            """
            machine = one("outputs['at'] = self.file_system_path; return 0")
            machine.root_state.states["ONEXXX"].add_output_data_port("at", str)
            folder = os.environ["OUT"] + "/m"
            storage.save_state_machine_to_path(machine, folder)
            state_machine_manager.remove_state_machine(machine.state_machine_id)
            loaded = engine.execute_state_machine_from_path(path=folder)
            print(loaded.root_state.final_outcome.name)
            print(os.path.relpath(loaded.root_state.states["ONEXXX"].output_data["at"], folder))
            """,
            """
            success
            one_ONEXXX
            """,
        )


if __name__ == "__main__":
    unittest.main()
