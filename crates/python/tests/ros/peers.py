"""What the tests against real peers share: the peer's process, the package, and who may hear whom.

The tests run by themselves (``cargo xtask ros``), in an interpreter with the back end that ``RAFCON_ROS_BACKEND`` names;
peers run in ``RAFCON_ROS_PEER_PYTHON``, which has ``rclpy``.
"""

import json
import os
import pathlib
import subprocess
import sys
import threading
import unittest

HERE = pathlib.Path(__file__).resolve().parent
PACKAGE = HERE.parents[1] / "python"
sys.path[:0] = [str(PACKAGE), str(HERE.parent)]

PEER_PYTHON = os.environ.get("RAFCON_ROS_PEER_PYTHON", sys.executable)
#: What the packages of a distribution set when their Python starts.
SET_BY_PACKAGES = ("LD_LIBRARY_PATH", "_ROS_WHEELS_BOOTSTRAP_COMPLETE")
#: A peer that takes longer than this is stuck; no test's answer depends on it.
STUCK_S = 600


class Peer:
    """A program of others; ``peer.heard("/topic", 3)`` has it carry out ``do_heard``."""

    def __init__(self, program="peer.py", *arguments, python=PEER_PYTHON):
        words = [python, str(HERE / program), *arguments]
        # What the packages of one distribution have set for their own libraries is wrong for those of another.
        env = {name: value for name, value in os.environ.items() if name not in SET_BY_PACKAGES}
        self.process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=env)
        self._watchdog = threading.Timer(STUCK_S, self.process.kill)
        self._watchdog.daemon = True
        self._watchdog.start()
        assert json.loads(self.process.stdout.readline()) == "up"

    def tell(self, *words):
        """Has it do something; its answer."""
        self.process.stdin.write(json.dumps(words) + "\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())

    def __getattr__(self, word):
        return lambda *arguments: self.tell(word, *arguments)

    def kill(self):
        """It is gone from one moment to the next."""
        self.process.kill()
        self.close()

    def close(self):
        """It ends properly."""
        self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()
        self._watchdog.cancel()


class Direct(Peer):
    """A script that calls a service by ``rclpy`` itself, without ``rafcon.ros``: what this is measured against."""

    def __init__(self, service):
        Peer.__init__(self, "direct.py", service)

    def __enter__(self):
        return self

    def __exit__(self, *_error):
        self.close()


class Beside(unittest.TestCase):
    """Tests that do something else at the same time."""

    def later(self, function, *arguments):
        """Runs beside the test."""
        answers = []
        thread = threading.Thread(target=lambda: answers.append(function(*arguments)))
        thread.start()

        def answer():
            thread.join()
            return answers[0]

        self.addCleanup(thread.join)
        return answer


class WithPeer(Beside):
    """Tests with one peer for all, and one node."""

    @classmethod
    def setUpClass(cls):
        cls.peer = Peer()
        cls.addClassCleanup(cls.peer.close)

    @classmethod
    def tearDownClass(cls):
        from rafcon import ros

        ros.close()
