"""The helper process of the native back end is killed, and kills nobody. Run with ``RAFCON_ROS_BACKEND=native``."""

import array
import math
import os
import select
import signal
import subprocess
import sys
import threading
import unittest

import peers

from rafcon import ros
from rafcon.ros import _native_frames, _node
from rafcon.ros._backend import BackendLost, Qos, Settings, UnknownType
from rafcon.ros._native import NativeBackend
from rafcon.ros._values import MessageError


class Heard:
    """Keeps what a back end says about itself."""

    def __init__(self):
        self.why = []
        self.lines = []
        self.ended = threading.Event()
        self.was_changed = threading.Event()
        self.was_told = threading.Event()

    def lost(self, why):
        self.why.append(why)
        self.ended.set()

    def changed(self):
        self.was_changed.set()

    def say(self, level, text):
        self.lines.append((level, text))
        if level == "error":
            self.was_told.set()


class Frames(unittest.TestCase):
    def test_what_is_packed_is_unpacked(self):
        message = {"a": b"\0\xff", "b": array.array("d", [1.5, math.inf]), "c": [True, "ä😀"], "d": {"e": -1, "f": b""}}
        frame = _native_frames.packed({"message": message})
        length = int.from_bytes(frame[4:8], "little")
        self.assertEqual(_native_frames.unpacked(frame[8 : 8 + length], memoryview(frame)[8 + length :]), {"message": message})


@unittest.skipUnless(os.environ.get("RAFCON_ROS_BACKEND") == "native", "the back end is another")
class Killed(unittest.TestCase):
    def setUp(self):
        self.heard = Heard()
        self.backend = NativeBackend()
        self.backend.start(Settings("killed"), self.heard)
        self.addCleanup(self.backend.close)

    def kill(self):
        os.kill(self.backend.pid, signal.SIGKILL)

    def lost(self):
        self.assertTrue(self.heard.ended.wait(peers.STUCK_S))
        self.assertEqual(self.heard.why, ["rafcon-ros ended by signal 9"])

    def test_while_nothing_is_done(self):
        self.kill()
        self.lost()
        with self.assertRaisesRegex(BackendLost, "the ROS node has ended: rafcon-ros ended by signal 9"):
            self.backend.publisher("/killed/topic", "std_msgs/msg/String", Qos())

    def test_while_a_call_waits(self):
        answers = []
        self.backend.service("/killed/never", "std_srvs/srv/Trigger", lambda request: None)
        client = self.backend.client("/killed/never", "std_srvs/srv/Trigger")
        client.send({}, lambda response, why: answers.append((response, why)))
        self.kill()
        self.lost()
        self.assertEqual(answers, [(None, "rafcon-ros ended by signal 9")])

    def test_while_something_is_published(self):
        publisher = self.backend.publisher("/killed/topic", "std_msgs/msg/String", Qos())
        self.kill()
        with self.assertRaises(BackendLost):
            while True:
                publisher.publish({"data": "x"})
        self.lost()

    def test_while_something_is_asked(self):
        self.kill()
        with self.assertRaises(BackendLost):
            while True:
                self.backend.describe("std_msgs/msg/String")
        self.lost()

    def test_a_message_that_is_too_large_is_told(self):
        publisher = self.backend.publisher("/killed/large", "std_msgs/msg/ByteMultiArray", Qos())
        publisher.publish({"layout": {"dim": [], "data_offset": 0}, "data": bytes(40 << 20)})
        self.assertTrue(self.heard.was_told.wait(peers.STUCK_S))
        lines = [text for level, text in self.heard.lines if level == "error"]
        self.assertEqual(lines, ["/killed/large: a message of 40 MB is not sent, 33 MB is the most that rafcon-ros carries: make it smaller, or use rclpy"])

    def test_a_text_with_a_nul_is_refused_with_its_place(self):
        publisher = self.backend.publisher("/killed/names", "sensor_msgs/msg/JointState", Qos())
        with self.assertRaisesRegex(MessageError, r"^sensor_msgs/msg/JointState\.name\[1\]: a NUL character cannot be in a text of ROS$"):
            publisher.publish({"name": ["a", "b\0c"]})

    def test_unknown_types(self):
        with self.assertRaisesRegex(UnknownType, "there is no type no_msgs/msg/Thing: .*RAFCON_ROS_TYPES"):
            self.backend.describe("no_msgs/msg/Thing")

    def test_the_helper_ends_with_a_run_that_is_killed(self):
        program = (
            "import os, signal, sys\n"
            f"sys.path.insert(0, {str(peers.PACKAGE)!r})\n"
            "from rafcon.ros._native import NativeBackend\n"
            "from rafcon.ros._backend import Settings\n"
            "backend = NativeBackend()\n"
            "backend.start(Settings('run'), type('L', (), {'changed': lambda s: None, 'say': lambda s, *a: None})())\n"
            "print(backend.pid, flush=True)\n"
            "os.kill(os.getpid(), signal.SIGKILL)\n"
        )
        run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, -signal.SIGKILL)
        helper = os.pidfd_open(int(run.stdout)) if os.path.exists(f"/proc/{run.stdout.strip()}") else None
        if helper is not None:
            self.assertTrue(select.select([helper], [], [], peers.STUCK_S)[0])
            os.close(helper)


#: Sends a goal that goes on until it is cancelled.
_CLIENT = f"""
import sys
sys.path.insert(0, {str(peers.PACKAGE)!r})
from rafcon import ros
ros.action("/peer/forever", 5, find=20)
"""


@unittest.skipUnless(os.environ.get("RAFCON_ROS_BACKEND") == "native", "the back end is another")
class Goals(unittest.TestCase):
    def test_the_goal_of_a_run_that_is_killed_is_cancelled(self):
        peer = peers.Peer()
        self.addCleanup(peer.close)
        run = subprocess.Popen([sys.executable, "-c", _CLIENT])
        self.assertEqual(peer.counted("forever accepted"), 1)
        run.kill()
        run.wait()
        self.assertEqual(peer.counted("forever cancel asked"), 1)
        self.assertEqual(peer.open("forever"), 0)


#: Serves one goal, which ends with a line on the standard input; then the process does, too. Feedback comes once its result was asked for.
_SERVER = f"""
import sys, threading
sys.path.insert(0, {str(peers.PACKAGE)!r})
from rafcon import ros
from rafcon.ros import _native_actions
asked, ended = threading.Event(), threading.Event()
take = _native_actions.ActionServer._take_result
def taken(self, request):
    take(self, request)
    asked.set()
_native_actions.ActionServer._take_result = taken
def work(goal):
    asked.wait()
    goal.feedback(sequence=[1])
    sys.stdin.readline()
    ended.set()
    return {{"sequence": [7]}}
server = ros.action_server("/ends/act", work, "example_interfaces/Fibonacci")
ended.wait()
server.join(10)
ros.close()
"""


@unittest.skipUnless(os.environ.get("RAFCON_ROS_BACKEND") == "native", "the back end is another")
class Ends(peers.Beside):
    def test_the_result_of_a_server_that_ends_arrives_at_a_client_that_is_late(self):
        self.addCleanup(ros.close)
        server = subprocess.Popen([sys.executable, "-c", _SERVER], stdin=subprocess.PIPE)
        self.addCleanup(server.wait)
        self.addCleanup(server.kill)
        begun = threading.Event()
        goal = self.later(lambda: ros.action("/ends/act", 5, find=20, feedback=lambda _message: begun.set()))
        self.assertTrue(begun.wait(peers.STUCK_S))
        helper = _node.node().backend.pid
        os.kill(helper, signal.SIGSTOP)
        # What the server says meanwhile, its farewell included, comes at once.
        server.communicate(b"\n")
        os.kill(helper, signal.SIGCONT)
        found = goal()
        self.assertEqual((found.outcome, found.result and list(found.result.sequence), found.why), ("succeeded", [7], ""))


if __name__ == "__main__":
    unittest.main()
