"""Commands of the bridge to ROS to a real server, without ROS."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import unittest

import stage  # noqa: F401, it brings the package
from rafcon.ros.bridge._client import Client
from rafcon.ros.bridge._commands import Commands
from rafcon.ros.bridge._watch import Watch
from support import BINARY, STUCK_S, save, script, sequence

WAITS = "def execute(self, inputs, outputs, gvm):\n    self.preemptive_wait()\n    return 0\n"


class Server:
    """A server with the machine `wait`."""

    def __init__(self, folder):
        folder = pathlib.Path(folder)
        save(folder / "robot" / "wait", sequence(script(WAITS)))
        words = [BINARY, "serve", str(folder / "robot"), "--bind", "127.0.0.1:0", "--python", sys.executable]
        words += ["--state", str(folder / "state"), "--runs", str(folder / "runs")]
        environment = {**os.environ, "HOME": str(folder)}
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment)
        self.watchdog = threading.Timer(STUCK_S, self.process.kill)
        self.watchdog.daemon = True
        self.watchdog.start()
        lines = iter(self.process.stdout)
        link = next(filter(None, (re.search(r"(http://\S+)/\?token=(\w+)", line) for line in lines)))
        self.client = Client(*link.groups())
        threading.Thread(target=list, args=(lines,), daemon=True).start()

    def close(self):
        self.process.terminate()
        self.process.wait()
        self.watchdog.cancel()


class Answers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        server = Server(folder.name)
        self.addCleanup(server.close)
        self.client = server.client
        watch = Watch(self.client, lambda: None, print)
        self.commands = Commands(self.client, watch, list)
        self.run_id = self.client.post(("runs",), {"id": "one", "machine": {"project": "robot", "path": "wait"}})["id"]
        self.client.post(("runs", self.run_id, "commands"), {"id": "pause", "command": {"type": "pause"}})

    def control(self):
        return self.client.get("runs", self.run_id, "control")["holder"]

    def test_a_refusal_has_its_own_reason_and_no_control_is_kept(self):
        answer = self.commands.command(self.run_id, "step")
        self.assertEqual(
            answer, {"success": False, "message": "nothing is held in this run; wait until a branch comes to its next state"}
        )
        self.assertIsNone(self.control())

    def test_control_is_given_back_after_a_command(self):
        self.assertEqual(self.commands.command(self.run_id, "resume"), {"success": True, "message": self.run_id})
        self.assertIsNone(self.control())

    def tearDown(self):
        self.client.post(("runs", self.run_id, "commands"), {"id": "stop", "command": {"type": "stop"}})


if __name__ == "__main__":
    unittest.main()
