"""``rafcon.ros`` in scripts of running machines: preemption, stop, steps back and the end of a run, against a real peer."""

import pathlib
import tempfile
import textwrap
import time
import unittest

from peers import Peer
from support import Runner, container, save, script, sequence

HEAD = "from rafcon import ros\nfrom rafcon.core.custom_exceptions import StatePreempted\n"


def scripted(body, id="A", backward=None):
    """A state whose script has a body."""
    text = HEAD + "def execute(self, inputs, outputs, gvm):\n" + textwrap.indent(textwrap.dedent(body).strip("\n"), "    ") + "\n"
    if backward is not None:
        text += "def backward_execute(self, inputs, outputs, gvm):\n" + textwrap.indent(textwrap.dedent(backward).strip("\n"), "    ") + "\n"
    return script(text, id=id)


class Machines(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.peer = Peer()
        cls.addClassCleanup(cls.peer.close)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def start(self, root, **options):
        return Runner(save(self.folder / "machine", root), **options)

    def stopped(self, body, when):
        """The run of a script that is stopped once something has happened; and how long that took."""
        runner = self.start(sequence(scripted(body)))
        when(runner)
        begin_s = time.monotonic()
        runner.command("stop")
        result = runner.finish()
        self.assertIn("-R/A=preempted", result.steps(), result.logged())
        return result, begin_s

    def waits(self, body):
        """A script that waits, is stopped, and leaves by *preempted*."""
        self.stopped(f"ros.now(); print('waits', flush=True)\n{body}\nreturn 0", lambda runner: runner.said("waits"))

    def test_each_wait_ends_by_a_stop(self):
        for body in (
            "ros.wait_for('/machines/none', 'std_msgs/String', timeout=None)",
            "ros.wait_for('/machines/none', timeout=None)",
            "ros.latest('/machines/none', timeout=None)",
            "ros.call('/machines/none', timeout=None, find=None)",
            "ros.call('/machines/none', None, 'std_srvs/Trigger', timeout=None, find=None)",
            "ros.call('/peer/never', timeout=None, find=None)",
            "ros.action('/machines/none', find=None)",
            "ros.publish('/machines/none', 'a', 'std_msgs/String', wait=1000)",
            "ros.param_get('/machines/none', 'a', timeout=None, find=None)",
            "ros.subscribe('/machines/none', 'std_msgs/String').next(timeout=None)",
        ):
            with self.subTest(body):
                self.waits(body)

    def check_cancelled(self, action, when, goal=5, more=""):
        result, begin_s = self.stopped(f"print(ros.action('/peer/{action}', {goal}{more}).outcome)\nreturn 0", when)
        self.assertEqual(self.peer.open(action), 0)
        return begin_s

    def test_a_goal_that_runs_is_cancelled(self):
        count = self.peer.counted("forever accepted", 0)
        begin_s = self.check_cancelled("forever", lambda _runner: self.peer.counted("forever accepted", count + 1))
        self.assertGreater(self.peer.cancelled()[-1], begin_s)

    def test_a_goal_that_is_accepted_after_the_stop_is_cancelled(self):
        asked = self.peer.counted("slow_accept asked", 0)
        self.check_cancelled("slow_accept", lambda _runner: self.peer.counted("slow_accept asked", asked + 1), 700)

    def test_a_goal_of_a_run_that_does_not_wait_for_its_end_is_cancelled(self):
        """The run has ended long before the goal is accepted; its process stays for that."""
        asked = self.peer.counted("slow_accept asked", 0)
        self.check_cancelled("slow_accept", lambda _runner: self.peer.counted("slow_accept asked", asked + 1), 700, ", cancel_wait_s=0")

    def test_a_server_that_does_not_cancel_is_left(self):
        for name in ("ignores_cancel", "refuses_cancel"):
            with self.subTest(name):
                count = self.peer.counted(name + " accepted", 0)
                body = f"ros.action('/peer/{name}', 5, cancel_wait_s=0.2)\nreturn 0"
                self.stopped(body, lambda _runner: self.peer.counted(name + " accepted", count + 1))

    def test_cleaning_up_can_still_call(self):
        body = """
            try:
                ros.action("/peer/forever", 5)
            finally:
                print(ros.call("/peer/set", False).message)
                ros.publish("/machines/stop", "stop", "std_msgs/String")
            return 0
        """
        self.peer.subscribe("/machines/stop")
        count = self.peer.counted("forever accepted", 0)
        result, _ = self.stopped(body, lambda _runner: self.peer.counted("forever accepted", count + 1))
        self.assertEqual(result.logged("stdout"), ["off"])
        self.assertEqual(self.peer.heard("/machines/stop", 1), ["stop"])
        self.assertEqual(self.peer.open("forever"), 0)

    def test_a_branch_that_is_preempted_cancels_while_others_go_on(self):
        children = [scripted("ros.action('/peer/forever', 5)\nreturn 0", f"B{number}") for number in range(19)]
        children.append(scripted("ros.wait_for('/machines/go', 'std_msgs/String', timeout=60)\nreturn 0", "Z"))
        transitions = [(child["id"], 0, 0) for child in children]
        count = self.peer.counted("forever accepted", 0)
        runner = self.start(container("preemptive", children, transitions))
        self.assertEqual(self.peer.counted("forever accepted", count + 19), count + 19)
        self.peer.publish("/machines/go", [])
        self.peer.subscribers("/machines/go", 1)
        self.peer.publish("/machines/go", ["go"])
        result = runner.finish()
        self.assertEqual(result.outcome, "success")
        self.assertEqual(sorted(step for step in result.steps() if "/B" in step and step[0] == "-"), sorted(f"-R/B{number}=preempted" for number in range(19)))
        self.assertEqual(self.peer.open("forever"), 0)

    def test_twenty_branches_share_a_node(self):
        body = "for number in range(10):\n    assert ros.call('/peer/set', number % 2 == 0, timeout=60).success == (number % 2 == 0)\nassert ros.action('/peer/quick', 5).outcome == 'succeeded'\nreturn 0"
        children = [scripted(body, f"B{number}") for number in range(20)]
        decide = script("def execute(self, inputs, outputs, gvm):\n    return 0\n", decider=True)
        transitions = [(None, None, "unique_decider_state_id")][:0] + [("unique_decider_state_id", 0, 0)]
        runner = self.start(container("barrier", [*children, decide], transitions))
        result = runner.finish()
        self.assertEqual(result.outcome, "success", [line for line in result.logged() if "rror" in line])

    def test_a_script_that_forgets_its_subscription_keeps_one(self):
        body = """
            ros.subscribe("/machines/kept", "std_msgs/String", print, timeout=0)
            gvm.set_variable("n", gvm.get_variable("n", default=0) + 1)
            return "again" if gvm.get_variable("n") < 30 else "success"
        """
        state = scripted(body)
        state["outcomes"] = ["success", "again"]
        last = scripted("ros.call('/peer/set', True)\nprint(len(ros._node.node().backend.subscriptions_of('/machines/kept')))\nreturn 0", "Z")
        root = container("hierarchy", [state, last], [(None, None, "A"), ("A", 0, "Z"), ("A", 1, "A"), ("Z", 0, 0)])
        result = self.start(root).finish()
        self.assertEqual((result.outcome, result.logged("stdout")), ("success", ["1"]))

    def test_the_end_of_a_run_ends_its_node(self):
        self.peer.publish("/machines/end", [])
        runner = self.start(sequence(scripted("ros.subscribe('/machines/end', 'std_msgs/String', print)\nreturn 0")))
        result = runner.finish()
        self.assertEqual((result.outcome, result.exit_code), ("success", 0), result.printed)
        self.assertEqual(self.peer.subscribers("/machines/end", 0), 0)

    def test_an_error_is_one_of_the_script(self):
        result = self.start(sequence(scripted("ros.publish('/machines/error', {'linaer': 1}, 'geometry_msgs/Twist')\nreturn 0"))).finish()
        self.assertEqual(result.outcome, "aborted")
        self.assertIn("geometry_msgs/msg/Twist has no field 'linaer'; is linear meant?", "\n".join(result.logged()))

    def test_a_step_back_over_a_goal_can_send_another(self):
        state = scripted("return 0", backward="print(ros.action('/peer/quick', 5).outcome)")
        runner = self.start(sequence(state, scripted("return 0", "B")), hold=True)
        held = lambda: runner.read_event(lambda event: event["type"] == "held")  # noqa: E731
        held()
        for name in ("step_over", "step_back"):
            runner.command(name, id=name)
            held()
        runner.command("resume", id="resume")
        self.assertEqual(runner.finish().logged("stdout"), ["succeeded"])

    def test_a_stop_ends_a_step_back_that_waits(self):
        state = scripted("return 0", backward="print('waits', flush=True)\nros.action('/peer/forever', 5)")
        accepted = self.peer.counted("forever accepted", 0)
        runner = self.start(sequence(state, scripted("return 0", "B")), hold=True)
        held = lambda: runner.read_event(lambda event: event["type"] == "held")  # noqa: E731
        held()
        runner.command("step_over", id="over")
        held()
        runner.command("step_back", id="back")
        self.peer.counted("forever accepted", accepted + 1)
        runner.command("stop", id="stop")
        self.assertEqual(runner.finish().outcome, "preempted")
        self.assertEqual(self.peer.open("forever"), 0)


if __name__ == "__main__":
    unittest.main()
