"""States side by side: real threads, preemption, pause and stop. The order of events decides, never time."""

import os
import signal
import socket
import tempfile
import unittest

from support import Runner, container, run, save, script, sequence

DONE = "def execute(self, inputs, outputs, gvm):\n    return 0\n"
#: Returns when every state beside it has come here too, which needs all of them to run at the same time.
MEET = """
import threading
def execute(self, inputs, outputs, gvm):
    gvm.get_variable("meeting", per_reference=True).wait()
    return 0
"""
CALL = """
import threading
def execute(self, inputs, outputs, gvm):
    gvm.set_variable("meeting", threading.Barrier(%d), per_reference=True)
    return 0
"""
WAIT = """
def execute(self, inputs, outputs, gvm):
    self.logger.info("waiting")
    preempted = self.preemptive_wait()
    print("preempted", preempted, self.preempted)
    return 0
"""
BEHIND_THE_DOOR = """
def execute(self, inputs, outputs, gvm):
    print("begun")
    with open(%r) as door, open(%r, "w") as proof:
        proof.write(door.read())
    return 0
"""
DECIDE = """
def execute(self, inputs, outputs, gvm):
    print(sorted((id, outcome.name) for id, (name, outcome) in self.final_outcomes_dict.items()))
    return 0
"""


def barrier(*children, id="BAR", decide=DECIDE):
    decider = script(decide, decider=True)
    return container("barrier", [*children, decider], [(decider["id"], 0, 0)], id=id)


def race(*children, id="RACE"):
    return container("preemptive", children, [(child["id"], 0, 0) for child in children], id=id)


class Concurrency(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def save(self, root):
        return save(self.folder, root)

    def test_children_run_at_the_same_time(self):
        children = [script(MEET, "C%d" % number) for number in range(20)]
        result = run(self.save(sequence(script(CALL % 20), barrier(*children))))
        self.assertEqual(result.outcome, "success")
        entered = [step for step in result.steps() if step.startswith("+R/BAR/C")]
        self.assertEqual(len(entered), 20)
        self.assertLess(result.steps().index(entered[-1]), result.steps().index("-R/BAR/C0=success"))

    def test_a_script_that_sleeps_holds_up_nobody(self):
        sleep = """
import socket
def execute(self, inputs, outputs, gvm):
    ours, theirs = gvm.get_variable("pair", per_reference=True)
    print(ours.recv(1))
    return 0
"""
        send = """
def execute(self, inputs, outputs, gvm):
    gvm.get_variable("pair", per_reference=True)[1].send(b"x")
    return 0
"""
        pair = """
import socket
def execute(self, inputs, outputs, gvm):
    gvm.set_variable("pair", socket.socketpair(), per_reference=True)
    return 0
"""
        root = sequence(script(pair), barrier(script(sleep, "ASLEEP"), script(send, "SENDER")))
        result = run(self.save(root))
        self.assertEqual(result.logged("stdout", "R/BAR/ASLEEP"), ["b'x'"])

    def test_the_first_to_end_preempts_waiting_scripts(self):
        root = sequence(race(script(DONE, "FIRST"), script(WAIT, "W1"), script(WAIT, "W2")))
        result = run(self.save(root))
        self.assertEqual(result.outcome, "success")
        for path in ("R/RACE/W1", "R/RACE/W2"):
            self.assertIn("-%s=preempted" % path, result.steps())
            self.assertEqual(result.logged("stdout", path), ["preempted True True"])

    def test_preemption_is_never_lost(self):
        inner = [container("hierarchy", [script(WAIT, "S")], [(None, None, "S"), ("S", 0, 0)], id="H%d" % n) for n in range(6)]
        again = "def execute(self, inputs, outputs, gvm):\n    n = gvm.get_variable('n', default=0) + 1\n    gvm.set_variable('n', n)\n    return 0 if n < 200 else 1\n"
        root = container(
            "hierarchy",
            [race(script(DONE, "FIRST"), *inner), script(again, "AGAIN", outcomes=("again", "enough"))],
            [(None, None, "RACE"), ("RACE", 0, "AGAIN"), ("AGAIN", 0, "RACE"), ("AGAIN", 1, 0)],
        )
        result = run(self.save(root), every_event=False)
        self.assertEqual(result.outcome, "success")
        self.assertEqual(result.finished["globals"], {"n": 200})

    def test_a_branch_of_many_states_keeps_its_thread(self):
        same = """
import threading
def execute(self, inputs, outputs, gvm):
    self.parent.seen = getattr(self.parent, "seen", []) + [threading.get_ident()]
    return 0
"""
        show = "def execute(self, inputs, outputs, gvm):\n    print(len(set(self.parent.seen)))\n    return 0\n"
        branch = sequence(*[script(same, "S%d" % n) for n in range(5)], script(show, "SHOW"), id="BRANCH")
        result = run(self.save(sequence(barrier(branch, script(DONE, "OTHER")))))
        self.assertEqual(result.logged("stdout", "R/BAR/BRANCH/SHOW"), ["1"])

    def test_stop_reaches_waiting_scripts(self):
        runner = Runner(self.save(sequence(script(WAIT), script(DONE, "NEVER"))))
        runner.entered("R/A")
        runner.command("stop")
        result = runner.finish()
        self.assertEqual(result.outcome, "preempted")
        self.assertEqual(result.logged("stdout"), ["preempted True True"])
        self.assertIn({"type": "stopping"}, result.events)
        self.assertIn({"message": "answer", "id": "1", "answer": "applied"}, result.messages)

    def test_sigterm_and_sigint_are_a_stop(self):
        for number in (signal.SIGTERM, signal.SIGINT):
            runner = Runner(self.save(sequence(script(WAIT))))
            runner.entered("R/A")
            runner.process.send_signal(signal.SIGHUP)
            runner.process.send_signal(number)
            result = runner.finish()
            self.assertEqual((result.outcome, result.exit_code), ("preempted", 0))

    def test_pause_holds_before_the_next_child(self):
        pause = """
def execute(self, inputs, outputs, gvm):
    print("begun")
    print(self.wait_for_interruption(), self.paused, self.preempted)
    return 0
"""
        go_on = "def execute(self, inputs, outputs, gvm):\n    print(self.paused, self.started)\n    return 0\n"
        runner = Runner(self.save(sequence(script(pause), script(go_on, "B"))))
        runner.said("begun")
        runner.command("pause", id="p")
        runner.read_event(lambda event: event["type"] == "left")
        held = runner.read(lambda message: message["message"] == "snapshot" and message["status"] == "paused")
        self.assertEqual([(state["path"], state["phase"]) for state in held["active"]], [("R", "held")])
        runner.command("resume", id="r")
        result = runner.finish()
        self.assertEqual(result.logged("stdout"), ["begun", "True True False", "False True"])
        paused = [event["paused"] for event in result.events if event["type"] == "paused"]
        self.assertEqual(paused, [True, False])

    def test_a_script_may_stop_the_machine(self):
        stop = "from rafcon.core.singleton import state_machine_execution_engine as engine\ndef execute(self, inputs, outputs, gvm):\n    engine.stop()\n    print(self.preemptive_wait())\n    return 0\n"
        result = run(self.save(sequence(script(stop), script(DONE, "B"))))
        self.assertEqual(result.outcome, "preempted")
        self.assertEqual(result.logged("stdout"), ["True"])

    def test_waiting_threads_sleep(self):
        busy = """
import glob
def wake_ups():
    lines = [line for path in glob.glob("/proc/self/task/*/status") for line in open(path)]
    return sum(int(line.split()[1]) for line in lines if line.startswith("voluntary_ctxt_switches"))
def execute(self, inputs, outputs, gvm):
    self.preemptive_wait(0.2)
    before = wake_ups()
    self.preemptive_wait(0.5)
    print(wake_ups() - before)
    return 0
"""
        children = [script(WAIT, "W%d" % n) for n in range(10)]
        result = run(self.save(sequence(race(script(busy, "CLOCK"), *children))))
        # Ten threads that looked every few milliseconds would wake up a thousand times.
        self.assertLess(int(result.logged("stdout", "R/RACE/CLOCK")[0]), 200)


class Commands(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.machine = save(folder.name, sequence(script(WAIT)))

    def begun(self):
        runner = Runner(self.machine)
        runner.entered("R/A")
        return runner

    def answer(self, runner, id):
        answer = runner.read(lambda message: message["message"] == "answer" and message["id"] == id)
        return answer["answer"], answer.get("reason", "")

    def end(self, runner):
        runner.command("stop", id="the end")
        return runner.finish()

    def test_the_same_id_is_carried_out_once(self):
        runner = self.begun()
        runner.command("pause", id="x")
        self.assertEqual(self.answer(runner, "x")[0], "applied")
        runner.command("resume", id="y")
        self.assertEqual(self.answer(runner, "y")[0], "applied")
        runner.command("pause", id="x")
        self.assertEqual(self.answer(runner, "x")[0], "applied")
        result = self.end(runner)
        self.assertEqual([event["paused"] for event in result.events if event["type"] == "paused"], [True, False])

    def test_a_late_command_expires(self):
        runner = self.begun()
        runner.command("stop", expiry=1)
        self.assertEqual(self.answer(runner, "1")[0], "expired")
        self.end(runner)

    def test_what_cannot_be_done_is_refused_with_the_reason(self):
        runner = self.begun()
        runner.command("resume", id="1")
        answer, reason = self.answer(runner, "1")
        self.assertEqual((answer, "running" in reason), ("refused", True))
        runner.command("step_over", id="2")
        answer, reason = self.answer(runner, "2")
        self.assertEqual((answer, "can be paused" in reason), ("refused", True), reason)
        runner.command("dance", id="3")
        self.assertEqual(self.answer(runner, "3")[0], "refused")
        self.end(runner)

    def test_nonsense_is_ignored_and_reported(self):
        runner = self.begun()
        runner.socket.sendall(b"\xff\xfe\n{]\n[1]\n")
        for _ in range(3):
            self.assertIn("ignored", runner.said("a viewer sent")["message"])
        self.assertEqual(self.end(runner).outcome, "preempted")

    def test_kill_ends_the_process_at_once(self):
        runner = self.begun()
        runner.said("waiting")
        runner.command("kill")
        result = runner.finish()
        self.assertEqual((result.exit_code, result.finished), (137, None))
        self.assertEqual(result.running_at_the_end(), ["R/A"])

    def test_the_run_goes_on_without_its_viewer(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        door, proof = folder.name + "/door", folder.name + "/proof"
        os.mkfifo(door)
        runner = Runner(save(folder.name + "/machine", sequence(script(BEHIND_THE_DOOR % (door, proof)))))
        runner.said("begun")
        runner.socket.shutdown(socket.SHUT_RDWR)
        with open(door, "w") as writing:
            writing.write("go on")
        runner.finish()
        with open(proof) as reading:
            self.assertEqual(reading.read(), "go on")


    def test_a_viewer_that_does_not_read_holds_up_nobody(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        door = folder.name + "/door"
        os.mkfifo(door)
        text = "def execute(self, inputs, outputs, gvm):\n    for n in range(100):\n        print(str(n)[-1] * 50_000)\n    open(%r, 'w').write('far')\n    return 0\n"
        runner = Runner(save(folder.name + "/machine", sequence(script(text % door))))
        with open(door) as reading:
            self.assertEqual(reading.read(), "far")
        result = runner.finish()
        self.assertEqual(len("".join(result.logged("stdout"))), 5_000_000)
        self.assertEqual(result.outcome, "success")

    def test_a_thread_that_a_script_left_behind_ends_by_a_signal(self):
        text = "import threading\ndef execute(self, inputs, outputs, gvm):\n    threading.Thread(target=threading.Event().wait).start()\n    return 0\n"
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        runner = Runner(save(folder.name, sequence(script(text))))
        runner.read()
        runner.process.terminate()
        result = runner.finish()
        self.assertEqual((result.outcome, result.exit_code), ("success", -signal.SIGTERM))


if __name__ == "__main__":
    unittest.main()
