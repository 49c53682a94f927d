"""The libraries of ``libraries/ros2``, each run as a machine, against a real peer."""

import importlib.util
import json
import os
import pathlib
import shutil
import tempfile
import unittest

from peers import Beside, Peer
from support import ROOT, Runner


class WithLibraries(Beside):
    """Runs libraries as machines."""

    def start(self, library, **inputs):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        machine = pathlib.Path(shutil.copytree(ROOT / "libraries/ros2" / library, pathlib.Path(folder.name, library)))
        core = json.loads((machine / "core_data.json").read_text())
        for port in core["input_data_ports"].values():
            port["default_value"] = inputs.pop(port["name"], port["default_value"])
        self.assertEqual(inputs, {}, "no such ports")
        (machine / "core_data.json").write_text(json.dumps(core))
        with (machine / "script.py").open("a") as script:
            script.write("\n\n_execute = execute\n\n\ndef execute(self, inputs, outputs, gvm):\n    outcome = _execute(self, inputs, outputs, gvm)\n    print(dict(outputs))\n    return outcome\n")
        return Runner(machine)


class Libraries(WithLibraries):
    @classmethod
    def setUpClass(cls):
        cls.peer = Peer()
        cls.addClassCleanup(cls.peer.close)

    def check(self, outcome, outputs, library, **inputs):
        result = self.start(library, **inputs).finish()
        self.assertEqual((result.outcome, result.logged("stdout")), (outcome, [outputs]), result.logged())

    def test_publish(self):
        self.peer.subscribe("/library/publish")
        self.check("success", "{}", "publish", topic="/library/publish", type="std_msgs/String", message="hello")
        self.assertEqual(self.peer.heard("/library/publish", 1), ["hello"])

    def test_wait_for(self):
        self.peer.publish("/library/wait", ["a", "b"], True)
        self.check("success", "{'message': {'data': 'b'}}", "wait_for", topic="/library/wait", condition="message.data > 'a'")
        self.check("timed_out", "{'message': None}", "wait_for", topic="/library/wait", condition="message.data > 'c'", timeout=2.0)

    def test_call(self):
        on, off = ("{'response': {'success': %s, 'message': '%s'}, 'why': '%s'}" % each for each in ((True, "on", ""), (False, "off", "off")))
        self.check("success", on, "call", service="/peer/set", request=True)
        self.check("failed", off, "call", service="/peer/set", request={"data": False})
        self.check(
            "no_server",
            "{'response': None, 'why': 'nobody offers the service /library/nothing (looked for 1.8 s): start its node, or correct the name'}",
            "call",
            service="/library/nothing",
        )

    def test_act(self):
        result = self.start("act", action="/peer/ok", goal={"order": 4}).finish()
        self.assertEqual(result.outcome, "succeeded", result.logged())
        self.assertIn("{'result': {'sequence': array('i', [0, 1, 1, 2])}", result.logged("stdout")[0])
        for name in ("abort", "reject"):
            self.assertEqual(self.start("act", action="/peer/" + name, goal=4).finish().outcome, {"abort": "aborted", "reject": "rejected"}[name])

    def test_act_is_stopped(self):
        count = self.peer.counted("forever accepted", 0)
        runner = self.start("act", action="/peer/forever", goal=4)
        self.peer.counted("forever accepted", count + 1)
        runner.command("stop")
        self.assertEqual(runner.finish().outcome, "preempted")
        self.assertEqual(self.peer.open("forever"), 0)

    def test_set_parameter(self):
        self.check("success", "{'before': 1.5, 'why': ''}", "set_parameter", node="/peer", name="speed", value=2)
        text = "the node /peer does not take speed = 20.0: too fast"
        self.check("refused", "{'before': 2.0, 'why': '%s'}" % text, "set_parameter", node="/peer", name="speed", value=20.0)

    def test_look_up_transform(self):
        result = self.start("look_up_transform", timeout=0.1).finish()
        # Without `tf2_msgs` in Python the state says so; `rafcon-ros` has it, and nobody publishes.
        native = os.environ.get("RAFCON_ROS_BACKEND") == "native"
        self.assertEqual(result.outcome, "timed_out" if native or importlib.util.find_spec("tf2_msgs") else "aborted", result.logged())
        self.assertIn("tf2_msgs" if result.outcome == "aborted" else "no transform", "\n".join(result.logged()))

    def test_wait_for_button(self):
        self.check("timed_out", "{}", "wait_for_button", topic="/library/joy", timeout=0.2)

    def test_record_bag_without_a_recorder(self):
        result = self.start("record_bag").finish()
        self.assertEqual(result.outcome, "no_recorder" if shutil.which("ros2") is None else "success")

    @unittest.skipIf(os.environ.get("RAFCON_ROS_BACKEND") == "native", "rafcon-ros has these types")
    def test_an_action_without_its_package_says_so(self):
        result = self.start("navigate_to_pose").finish()
        self.assertEqual(result.outcome, "aborted")
        self.assertIn("nav2_msgs", "\n".join(result.logged()))


if __name__ == "__main__":
    unittest.main()
