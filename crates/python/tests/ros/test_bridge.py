"""``rafcon serve --ros`` with real runs: machines as actions for a node of plain ``rclpy``, and for ``rafcon.ros``.

The binary and the extension are those of the debug build, or of ``RAFCON_BINARY`` and ``RAFCON_EXTENSION``.
"""

import contextlib
import json
import os
import pathlib
import queue
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import urllib.error
import urllib.request

from peers import PACKAGE, STUCK_S, WithPeer
from support import BINARY, EXTENSION

from rafcon import ros

#: The interpreter of runs and of the bridge.
PYTHON = os.environ.get("RAFCON_PYTHON", sys.executable)
NATIVE = os.environ.get("RAFCON_ROS_BACKEND") == "native"
#: Of the state of goals.
SUCCEEDED, CANCELED, ABORTED = 4, 5, 6

SCRIPTS = {
    "fib": """
        numbers = [0, 1]
        while len(numbers) < inputs["order"]:
            numbers.append(numbers[-1] + numbers[-2])
        outputs["sequence"] = numbers[:inputs["order"]]
        return "success"
    """,
    "wait": """
        self.preemptive_wait()
        return "preempted"
    """,
    "fail": """
        raise ValueError("no")
    """,
}
#: An action that a machine declares, with its input and its output.
FIBONACCI = {"name": "/machines/NAME", "type": "test_msgs/action/Fibonacci"}

BUILD = """
import importlib.machinery, importlib.util, json, sys, textwrap
loader = importlib.machinery.ExtensionFileLoader("rafcon._native", sys.argv[1])
spec = importlib.util.spec_from_file_location("rafcon._native", loader.path, loader=loader)
sys.modules["rafcon._native"] = importlib.util.module_from_spec(spec)
loader.exec_module(sys.modules["rafcon._native"])
sys.path.insert(0, sys.argv[3])
from rafcon.core.state_machine import StateMachine
from rafcon.core.states.execution_state import ExecutionState
from rafcon.core.states.hierarchy_state import HierarchyState
from rafcon.core.storage import storage
for name, script, semantic in json.load(sys.stdin):
    child, root = ExecutionState("Work"), HierarchyState(name.title())
    ports = [[state.add_input_data_port("order", int, 3), state.add_output_data_port("sequence", list)] for state in (child, root)]
    child.script_text = "def execute(self, inputs, outputs, gvm):" + textwrap.indent(textwrap.dedent(script), "    ")
    root.add_state(child)
    root.set_start_state(child)
    root.add_transition(child.state_id, 0, root.state_id, 0)
    root.add_data_flow(root.state_id, ports[1][0], child.state_id, ports[0][0])
    root.add_data_flow(child.state_id, ports[0][1], root.state_id, ports[1][1])
    for key, value in semantic.items():
        root.semantic_data[key] = value
    storage.save_state_machine_to_path(StateMachine(root), sys.argv[2] + "/" + name)
"""


class Served:
    """A server with machines and a bridge."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.project = self.folder / "robot"
        self.project.mkdir()
        machines = [[name, script, {"ros": {"action": {**FIBONACCI, "name": "/machines/" + name}}}] for name, script in SCRIPTS.items()]
        words = [PYTHON, "-c", BUILD, EXTENSION, str(self.project), str(PACKAGE)]
        subprocess.run(words, input=json.dumps(machines), text=True, check=True)
        self.lines = queue.Queue()
        self.process = None

    def start(self):
        words = [BINARY, "serve", str(self.project), "--ros=/robot", "--bind", "127.0.0.1:0", "--python", PYTHON]
        words += ["--state", str(self.folder / "state"), "--runs", str(self.folder / "runs")]
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.watchdog = threading.Timer(STUCK_S, self.process.kill)
        self.watchdog.daemon = True
        self.watchdog.start()
        self.said = []
        self.link = self.until(r"(http://\S+)/\?token=(\w+)").groups()
        for name in sorted(SCRIPTS):
            self.until(f"is the action /machines/{name} ")

    def until(self, pattern):
        """Reads what the server says until a line has this."""
        for line in self.process.stdout:
            self.said.append(line)
            found = re.search(pattern, line)
            if found:
                return found
        raise AssertionError(f"the server ended without saying {pattern}: {''.join(self.said)}")

    def ask(self, method, path, body=None):
        """Asks the server as its owner."""
        url, token = self.link
        headers = {"Authorization": f"Bearer {token}", "Content-Type": "application/json"}
        data = None if body is None else json.dumps(body).encode()
        with urllib.request.urlopen(urllib.request.Request(f"{url}/api/v1{path}", data, headers, method=method)) as answer:
            return json.load(answer)

    def live(self):
        return [each["id"] for each in self.ask("GET", "/runs") if each["phase"] == "live"]

    def stop_all(self):
        """Stops what runs, and returns when nothing does."""
        for run in self.live():
            # One that has ended meanwhile cannot be stopped.
            with contextlib.suppress(urllib.error.HTTPError):
                self.ask("POST", f"/runs/{run}/commands", {"id": f"end-{run}", "command": {"type": "stop"}})
        while self.live():
            pass

    def bridge(self):
        """The number of the bridge's process."""
        children = [file.read_text().split() for file in pathlib.Path(f"/proc/{self.process.pid}/task").glob("*/children")]
        for pid in sum(children, []):
            if b"the bridge to ROS 2" in pathlib.Path(f"/proc/{pid}/cmdline").read_bytes():
                return int(pid)
        raise AssertionError("there is no bridge")

    def end(self, how=signal.SIGTERM):
        self.process.send_signal(how)
        self.process.wait()
        self.watchdog.cancel()
        self.process.stdout.close()

    def kill(self):
        """A test that failed leaves none."""
        if self.process is not None and self.process.poll() is None:
            self.end(signal.SIGKILL)


class WithServer(WithPeer):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.served = Served(folder.name)
        cls.served.start()
        cls.addClassCleanup(cls.served.end)

    def setUp(self):
        self.addCleanup(self.served.stop_all)


class Actions(WithServer):
    """For a node that knows nothing of RAFCON."""

    def test_a_machine_is_an_action(self):
        self.assertEqual(self.peer.goal("/machines/fib", 6)[:2], [SUCCEEDED, [0, 1, 1, 2, 3, 5]])
        self.assertEqual(self.peer.goal("/machines/fib", 1)[:2], [SUCCEEDED, [0]])

    def test_a_failed_run_is_an_aborted_goal(self):
        self.assertEqual(self.peer.goal("/machines/fail", 2)[:2], [ABORTED, []])

    def test_cancel_is_stop(self):
        self.assertEqual(self.peer.goal("/machines/wait", 2, True)[:2], [CANCELED, []])
        self.assertEqual(self.served.live(), [])

    def test_a_goal_is_rejected_while_somebody_has_control(self):
        run = self.served.ask("POST", "/runs", {"id": "own", "machine": {"project": "robot", "path": "wait"}})["id"]
        self.served.ask("POST", f"/runs/{run}/control", {"move": "request"})
        self.assertEqual(self.peer.goal("/machines/fib", 3)[0], "rejected")
        self.served.until(f"a goal of /machines/fib is rejected: owner holds control of the run {run}")


class Services(WithServer):
    """For any node."""

    def test_the_run_in_progress_is_paused_and_stopped(self):
        self.assertEqual(self.peer.call("/robot/pause", 1), [[False, "no run is in progress"]])
        run = self.served.ask("POST", "/runs", {"id": "one", "machine": {"project": "robot", "path": "wait"}})["id"]
        self.assertEqual(self.peer.call("/robot/pause", 1), [[True, run]])
        self.assertEqual(self.peer.call("/robot/step", 1), [[False, "nothing is held in this run; wait until a branch comes to its next state"]])
        for word in ("resume", "stop"):
            self.assertEqual(self.peer.call("/robot/" + word, 1), [[True, run]], word)
        self.assertIsNone(self.served.ask("GET", f"/runs/{run}/control")["holder"])

    def test_rviz_is_shown_what_runs_and_nothing_once_it_is_over(self):
        self.addCleanup(ros.close)
        self.served.ask("POST", "/runs", {"id": "shown", "machine": {"project": "robot", "path": "wait"}})
        shows = lambda message: any("robot/wait: running\nWait/Work" in each.text for each in message.markers)  # noqa: E731
        with ros.subscribe("/robot/markers", "visualization_msgs/MarkerArray", qos="latched") as markers:
            self.assertTrue(markers.next(20, shows))
            self.served.stop_all()
            self.assertTrue(markers.next(20, lambda message: not shows(message)))


@unittest.skipUnless(NATIVE, "rclpy knows rafcon_msgs only where the package was built")
class RunMachine(WithServer):
    """With the types of the bridge."""

    def test_any_machine_runs(self):
        told = []
        ended = ros.action("/robot/run_machine", {"machine": "fib", "inputs": '{"order": 4}'}, find=20, feedback=told.append)
        self.assertEqual((ended.outcome, ended.result.outcome, json.loads(ended.result.outputs)), ("succeeded", "success", {"sequence": [0, 1, 1, 2]}))
        self.assertEqual(self.served.ask("GET", f"/runs/{ended.result.run}")["run"]["author"], "ros")

    def test_a_result_is_whole_whatever_its_length(self):
        ended = ros.action("/robot/run_machine", {"machine": "fib", "inputs": '{"order": 2000}'}, find=20)
        # JSON has no integers of this size.
        outputs = json.loads(ended.result.outputs, object_hook=lambda each: int(each["__int__"]) if "__int__" in each else each)
        sequence = outputs["sequence"]
        self.assertEqual((ended.outcome, len(sequence), sequence[1999] - sequence[1998]), ("succeeded", 2000, sequence[1997]))

    def test_a_failure_is_told_in_words(self):
        ended = ros.action("/robot/run_machine", {"machine": "robot/fail"}, find=20)
        self.assertEqual((ended.outcome, ended.result.outcome), ("aborted", "aborted"))
        self.assertEqual(ended.result.message, f"the run {ended.result.run} ended with the outcome `aborted`")

    def test_what_cannot_begin_is_rejected_with_a_reason(self):
        for goal, why in (
            ({"machine": "none"}, "there is no machine `none`; there are robot/fail, robot/fib, robot/wait"),
            ({"machine": "fib", "inputs": "[]"}, "`inputs` is JSON, and no object"),
            ({"machine": "fib", "inputs": '{"other": 1}'}, "robot/fib has no input `other`; it has order"),
        ):
            self.assertEqual(ros.action("/robot/run_machine", goal, find=20).outcome, "rejected", goal)
            self.served.until("a goal of run_machine is rejected: .*" + re.escape(why))

    def test_feedback_has_the_active_states(self):
        active = queue.Queue()
        ended = self.later(lambda: ros.action("/robot/run_machine", {"machine": "wait"}, find=20, feedback=active.put))
        first = active.get(timeout=20)
        while list(first.active) != ["Wait/Work"]:
            first = active.get(timeout=20)
        self.assertEqual(ros.call("/robot/command", {"run": first.run, "command": "stop"}).as_dict(), {"success": True, "message": first.run})
        self.assertEqual((ended().outcome, ended().result.outcome), ("aborted", "preempted"))

    def test_machines_and_runs_are_listed(self):
        listed = ros.call("/robot/list", find=20)
        self.assertEqual([each.machine for each in listed.machines], ["robot/fail", "robot/fib", "robot/wait"])

    def test_commands_are_answered_with_reasons(self):
        self.assertRegex(ros.call("/robot/command", {"command": "jump"}, find=20).message, "`jump` is no command: write one of pause, ")
        self.assertRegex(ros.call("/robot/command", {"run": "none", "command": "stop"}).message, "none")

    def test_no_more_goals_than_there_may_be(self):
        from rafcon.ros.bridge._goals import GOALS_MAX

        runs = queue.Queue()
        goal = {"machine": "wait"}
        ends = [self.later(lambda: ros.action("/robot/run_machine", goal, find=20, feedback=lambda told: runs.put(told.run))) for _ in range(GOALS_MAX)]
        known = set()
        while len(known) < GOALS_MAX:
            known.add(runs.get(timeout=60))
        self.assertEqual(ros.action("/robot/run_machine", goal).outcome, "rejected")
        self.served.stop_all()
        self.assertEqual({end().outcome for end in ends}, {"aborted"})

    def test_the_state_is_there_for_who_comes_late(self):
        ended = ros.action("/robot/run_machine", {"machine": "fib"}, find=20)
        is_told = lambda message: any(each.hardware_id == ended.result.run and each.message == "finished: success" for each in message.status)  # noqa: E731
        self.assertTrue(ros.wait_for("/robot/state", "diagnostic_msgs/DiagnosticArray", is_told, 20, qos="latched"))


@unittest.skipUnless(NATIVE, "rclpy knows rafcon_msgs only where the package was built")
class Ends(unittest.TestCase):
    """The server goes, the run stays."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.served = Served(folder.name)
        self.addCleanup(self.served.kill)
        self.served.start()
        self.addCleanup(ros.close)

    def goal_whose_server_ends(self, how):
        told, ended = queue.Queue(), queue.Queue()
        goal = {"machine": "wait"}
        thread = threading.Thread(target=lambda: ended.put(ros.action("/robot/run_machine", goal, find=20, feedback=told.put)))
        thread.start()
        run = told.get(timeout=30).run
        begun_s = time.monotonic()
        self.served.end(how)
        found = ended.get(timeout=30)
        thread.join()
        print(f"after {signal.Signals(how).name}: {found.outcome} in {time.monotonic() - begun_s:.2f} s", flush=True)
        return run, found

    def test_a_bridge_that_dies_is_started_again_and_no_run_ends(self):
        told, ended = queue.Queue(), queue.Queue()
        thread = threading.Thread(target=lambda: ended.put(ros.action("/robot/run_machine", {"machine": "wait"}, find=20, feedback=told.put)))
        thread.start()
        run = told.get(timeout=30).run
        os.kill(self.served.bridge(), signal.SIGKILL)
        self.assertEqual(ended.get(timeout=30).outcome, "aborted")
        thread.join()
        self.served.until(r"the bridge to ROS has ended \(killed by signal 9 \(SIGKILL\)\)")
        self.served.until("robot/wait is the action /machines/wait")
        self.assertEqual(self.served.live(), [run])
        self.assertEqual(ros.action("/robot/run_machine", {"machine": "fib"}, find=20).outcome, "succeeded")
        self.served.stop_all()
        self.served.end()

    def test_a_goal_whose_server_dies_is_aborted_and_its_run_goes_on(self):
        for how in (signal.SIGKILL, signal.SIGTERM):
            run, ended = self.goal_whose_server_ends(how)
            self.assertEqual(ended.outcome, "aborted")
            self.assertEqual(ended.result.message, f"the server of RAFCON has ended; the run {run} goes on without it")
            ros.close()
            self.served.start()
            self.assertIn(run, self.served.live())
            self.served.stop_all()
        self.served.end()


if __name__ == "__main__":
    unittest.main()
