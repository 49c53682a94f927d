"""``rafcon.ros`` in a plain interpreter, against a node of plain ``rclpy``."""

import math
import threading
import time
import unittest

from peers import Peer, WithPeer

from rafcon import ros
from rafcon.ros import _node
from rafcon.ros._waits import Waiter


class Topics(WithPeer):
    def test_what_is_published_is_heard(self):
        self.peer.subscribe("/topics/there")
        texts = [f"text {number}" for number in range(1000)]
        for text in texts:
            ros.publish("/topics/there", text, "std_msgs/String", qos=2000)
        self.assertEqual(self.peer.heard("/topics/there", 1000), texts)

    def test_what_others_publish_is_heard(self):
        with ros.subscribe("/topics/back", "std_msgs/String", qos=2000) as heard:
            self.peer.publish("/topics/back", [])
            self.peer.subscribers("/topics/back", 1)
            texts = [f"text {number}" for number in range(1000)]
            self.peer.publish("/topics/back", texts)
            self.assertEqual([heard.next().data for _ in texts], texts)
            with self.assertRaises(ros.TimedOut) as caught:
                heard.next(timeout=0.05)
        self.assertEqual(str(caught.exception), "no message came on /topics/back (std_msgs/msg/String) in 0.05 s")

    def test_a_callback_has_each_message(self):
        heard, all_come = [], threading.Event()

        def hear(message):
            heard.append(message.data)
            if len(heard) == 3:
                all_come.set()

        with ros.subscribe("/topics/called", "std_msgs/String", hear):
            self.peer.publish("/topics/called", [])
            self.peer.subscribers("/topics/called", 1)
            self.peer.publish("/topics/called", ["a", "b", "c"])
            self.assertTrue(all_come.wait(20))
        self.assertEqual(heard, ["a", "b", "c"])
        self.peer.subscribers("/topics/called", 0)

    def test_latched_messages_are_there_for_who_comes_late(self):
        self.peer.publish("/topics/latched", ["kept"], True)
        self.assertEqual(ros.latest("/topics/latched", timeout=20).data, "kept")
        self.assertEqual(ros.wait_for("/topics/latched").data, "kept")
        ros.publish("/topics/ours", "kept", "std_msgs/String", qos="latched", wait=0)
        self.peer.subscribe("/topics/ours", True)
        self.assertEqual(self.peer.heard("/topics/ours", 1), ["kept"])

    def test_what_is_best_effort_is_heard_as_such(self):
        self.peer.publish("/topics/sensor", [], False, True)
        heard = self.later(ros.wait_for, "/topics/sensor", None, lambda message: message.data == "b", 20)
        self.peer.subscribers("/topics/sensor", 1)
        self.peer.publish("/topics/sensor", ["a", "b"], False, True)
        self.assertEqual(heard().data, "b")

    def test_a_subscription_that_no_publisher_fits_says_why(self):
        self.peer.publish("/topics/careless", [], False, True)
        with ros.subscribe("/topics/careless", "std_msgs/String", qos=ros.Qos("reliable", "transient_local", 1)) as heard:
            Waiter("the publisher").until(lambda: any(each.node for each in _node.node().backend.publishers_of("/topics/careless")), 20, 0.01)
            with self.assertRaises(ros.TimedOut) as caught:
                heard.next(timeout=0)
        self.assertEqual(
            str(caught.exception),
            "no message came on /topics/careless (std_msgs/msg/String) in 0 s: /peer keeps no messages, and this subscription is latched; "
            "/peer publishes with best effort, and this subscription is reliable: leave `qos` out",
        )

    def test_nothing_comes(self):
        self.assertIsNone(ros.latest("/topics/nothing", "std_msgs/String", timeout=0.05))
        self.assertIsNone(ros.latest("/topics/nothing", timeout=0.05))
        with self.assertRaisesRegex(ros.TimedOut, "nobody uses the topic /topics/none, so its type is not known"):
            ros.wait_for("/topics/none", timeout=0.05)

    def test_two_types_on_one_topic(self):
        self.peer.publish("/topics/mixed", [], True)
        with ros.subscribe("/topics/mixed", timeout=20) as heard:
            self.assertEqual(heard.type_name, "std_msgs/msg/String")
            with self.assertRaisesRegex(ros.RosError, "cannot publish std_msgs/msg/Int32 on /topics/mixed: this run uses it as std_msgs/msg/String already"):
                ros.publish("/topics/mixed", 5, "std_msgs/Int32", wait=0)
        self.peer.publish("/topics/other", [], True)
        # The name of its node comes later than the topic.
        Waiter("the publisher").until(lambda: any(each.node for each in _node.node().backend.publishers_of("/topics/other")), 20, 0.01)
        with self.assertLogs("rafcon.ros", "WARNING") as said, ros.subscribe("/topics/other", "std_msgs/Int32"):
            with self.assertRaisesRegex(ros.RosError, "has several types, std_msgs/msg/Int32 and std_msgs/msg/String; say which"):
                ros.wait_for("/topics/other", timeout=0)
        self.assertIn("is used as std_msgs/msg/Int32 here and as std_msgs/msg/String by /peer", said.output[-1])

    def test_every_kind_of_field_goes_there_and_back(self):
        sent = ros.Message(
            "test_msgs/UnboundedSequences",
            bool_values=[True, False],
            byte_values=b"\0\xff",
            char_values=[0, 255],
            float32_values=[0.5, math.inf],
            float64_values=[0.1, -math.inf],
            int8_values=[-128, 127],
            uint64_values=[2**64 - 1],
            string_values=["", "ä€😀"],
            basic_types_values=[{"int32_value": -5}, {"int8_value": 7}],
        )
        arrays = ros.Message("test_msgs/Arrays", float64_values=[1, 2, math.nan], uint8_values=b"abc", string_values=["a", "b", "c"])
        for message in (sent, arrays, ros.Message("test_msgs/Defaults"), ros.Message("test_msgs/Empty"), ros.Message("test_msgs/WStrings")):
            topic = "/topics/" + message.type_name.rpartition("/")[2].lower()
            with ros.subscribe(topic, message.type_name) as heard:
                ros.publish(topic, message)
                self.assertEqual(repr(heard.next(20)), repr(message))

    def test_a_large_message(self):
        content = bytes(range(256)) * 32768
        with ros.subscribe("/topics/large", "sensor_msgs/Image", qos=1) as heard:
            ros.publish("/topics/large", {"height": 1024, "width": 8192, "data": content}, "sensor_msgs/Image", qos=1)
            self.assertEqual(heard.next(20).data, content)

    def test_unknown_types(self):
        for name, text in (
            ("no_msgs/Thing", "there is no type no_msgs/msg/Thing"),
            ("std_msgs/Thing", "there is no type std_msgs/msg/Thing"),
            ("Thing", "'Thing' is no name of a type"),
        ):
            with self.assertRaisesRegex(ros.UnknownType, text):
                ros.publish("/topics/unknown", {}, name)


class Services(WithPeer):
    def test_a_call(self):
        response = ros.call("/peer/set", True)
        self.assertEqual((response.success, response.message), (True, "on"))
        request = {"float32_value": math.nan, "int64_value": -(2**63), "string_value": "ä", "byte_value": 255}
        self.assertEqual({name: repr(ros.call("/peer/echo", request)[name]) for name in request}, {name: repr(value) for name, value in request.items()})

    def test_a_thousand_calls_on_twenty_threads(self):
        def call(number):
            return [ros.call("/peer/echo", {"int32_value": number * 50 + each}, timeout=60)["int32_value"] for each in range(50)]

        answers = [self.later(call, number) for number in range(20)]
        self.assertEqual(sum((answer() for answer in answers), []), list(range(1000)))

    def test_nobody_serves(self):
        start_s = time.monotonic()
        for arguments in (("/services/nothing",), ("/services/nothing", None, "std_srvs/Trigger")):
            with self.assertRaisesRegex(ros.NoServer, "nobody offers the service /services/nothing"):
                ros.call(*arguments, find=0.2)
        self.assertLess(time.monotonic() - start_s, 20)

    def test_no_answer(self):
        with self.assertRaisesRegex(ros.TimedOut, "the service /peer/never has not answered within 0.1 s"):
            ros.call("/peer/never", timeout=0.1)

    def test_others_call_what_a_script_offers(self):
        calls = []

        def answer(request):
            calls.append(request.as_dict())
            return {"success": True, "message": f"call {len(calls)}"}

        with ros.serve("/services/ours", answer, "std_srvs/Trigger"):
            self.assertEqual(self.peer.call("/services/ours", 1000), [[True, f"call {number}"] for number in range(1, 1001)])
        self.assertEqual(calls, [{}] * 1000)

    def test_a_callback_that_fails_is_told(self):
        def fail(_request):
            raise ValueError("no")

        with ros.serve("/services/failing", fail, "std_srvs/Trigger"), self.assertLogs("rafcon.ros", "ERROR"):
            self.assertEqual(self.peer.call("/services/failing", 1), [[False, "ValueError: no"]])


class Parameters(WithPeer):
    def test_they_are_read_and_set(self):
        ros.param_set("/peer", {"speed": 2, "label": "b", "counts": [4]})
        self.assertEqual(ros.param_get("/peer", ["speed", "label", "counts"]), {"speed": 2.0, "label": "b", "counts": [4]})
        self.assertEqual(repr(ros.param_get("peer", "speed")), "2.0")

    def test_what_is_refused_says_why(self):
        for name, value, text in (
            ("speed", 11.0, "the node /peer does not take speed = 11.0: too fast"),
            ("label", 5, "the node /peer does not take label = 5: "),
            ("label", None, "label = None: a parameter is a bool"),
        ):
            with self.assertRaises(ros.ParameterError) as caught:
                ros.param_set("/peer", name, value)
            self.assertIn(text, str(caught.exception))
        with self.assertRaisesRegex(ros.ParameterError, "the node /peer does not have weight"):
            ros.param_get("/peer", "weight")
        with self.assertRaises(ros.NoServer):
            ros.param_get("/nobody", "speed", find=0.1)


class Actions(WithPeer):
    def test_the_outcomes(self):
        for name, outcome, result, feedback in (
            ("ok", "succeeded", [0, 1, 1, 2, 3], True),
            ("quick", "succeeded", [0, 1, 1, 2, 3], False),
            ("abort", "aborted", [0, 1, 1, 2, 3], True),
            ("reject", "rejected", None, False),
        ):
            with self.subTest(name):
                ended = ros.action("/peer/" + name, 5)
                self.assertEqual((ended.outcome, ended.result and list(ended.result.sequence)), (outcome, result))
                self.assertTrue(ended.feedback is None or feedback)

    def test_time_is_over(self):
        told = []
        ended = ros.action("/peer/forever", 5, timeout=1, feedback=told.append)
        self.assertEqual((ended.outcome, list(ended.result.sequence)), ("timed_out", [0, 1]))
        self.assertEqual([list(each.sequence) for each in told], [[7]])
        self.assertEqual(self.peer.open("forever"), 0)

    def test_a_goal_that_is_accepted_too_late_is_cancelled(self):
        ended = ros.action("/peer/slow_accept", 300, accept=0.05)
        self.assertEqual((ended.outcome, ended.why), ("timed_out", "/peer/slow_accept: its server has not accepted the goal within 0.05 s"))
        self.peer.counted("slow_accept accepted")
        self.assertEqual(self.peer.open("slow_accept"), 0)

    def test_nobody_serves(self):
        for arguments in (("/actions/nothing", 5), ("/actions/nothing", 5, "test_msgs/Fibonacci")):
            ended = ros.action(*arguments, find=0.1)
            self.assertEqual(ended.outcome, "timed_out")
            self.assertIn("nobody offers the action /actions/nothing", ended.why)

    def test_an_action_under_a_second_type_is_refused(self):
        self.assertEqual(ros.action("/peer/quick", 5).outcome, "succeeded")
        with self.assertRaisesRegex(ros.RosError, "^cannot .*/peer/quick"):
            ros.action("/peer/quick", {}, "test_msgs/NestedMessage")

    def test_others_send_goals_to_a_script(self):
        def work(goal):
            numbers = [0, 1]
            for _ in range(goal.goal.order - 2):
                numbers.append(numbers[-1] + numbers[-2])
                goal.feedback(sequence=numbers)
            if goal.goal.order == 3:
                raise ros.GoalAborted("three is too few", {"sequence": [3]})
            while goal.goal.order == 2 and not goal.wait(1):
                pass
            return {"sequence": numbers}

        with ros.action_server("/actions/ours", work, "test_msgs/Fibonacci", accept=lambda goal: goal.order > 1):
            self.assertEqual(self.peer.goal("/actions/ours", 5, False, 3), [4, [0, 1, 1, 2, 3], 3])
            self.assertEqual(self.peer.goal("/actions/ours", 3)[:2], [6, [3]])
            self.assertEqual(self.peer.goal("/actions/ours", 2, True)[:2], [5, [0, 1]])
            self.assertEqual(self.peer.goal("/actions/ours", 1)[0], "rejected")


class Gone(unittest.TestCase):
    """A peer that is killed."""

    def check(self, wait, when, then=lambda: None):
        from rafcon import ros

        self.addCleanup(ros.close)
        peer = Peer()
        killer = threading.Thread(target=lambda: (peer.counted(when), heard_of(peer), peer.kill(), then()))
        killer.start()
        self.addCleanup(killer.join)
        return wait()

    def again(self):
        """What starts another at once: it has the same name, and the ports of the one that died."""
        peer = Peer("peer.py", "asleep")
        self.addCleanup(peer.close)
        return lambda: peer.tell("start")

    def call_never(self):
        with self.assertRaisesRegex(ros.NoServer, "^the service /peer/never: its server has ended$"):
            ros.call("/peer/never", timeout=60, find=20)

    def test_while_a_call_waits(self):
        self.check(self.call_never, "never called")

    def test_while_a_call_waits_and_its_server_is_started_again(self):
        self.check(self.call_never, "never called", self.again())

    def test_while_a_goal_runs_and_its_server_is_started_again(self):
        ended = self.check(lambda: ros.action("/peer/forever", 5, find=20, timeout=60), "forever accepted", self.again())
        self.assertEqual((ended.outcome, ended.why), ("aborted", "/peer/forever: its server has ended"))

    def test_while_a_goal_runs(self):
        ended = self.check(lambda: ros.action("/peer/forever", 5, find=20), "forever accepted")
        self.assertEqual((ended.outcome, ended.why), ("aborted", "/peer/forever: its server has ended"))

    def test_before_a_goal_is_accepted(self):
        ended = self.check(lambda: ros.action("/peer/never_accept", 5, find=20, accept=60), "never_accept asked")
        self.assertEqual((ended.outcome, ended.why), ("aborted", "/peer/never_accept: its server has ended"))

    def test_while_a_goal_is_cancelled(self):
        ended = self.check(
            lambda: ros.action("/peer/ignores_cancel", 5, find=20, timeout=0.2, cancel_wait_s=60), "ignores_cancel cancel asked"
        )
        self.assertEqual(ended.outcome, "timed_out")


def heard_of(peer):
    """Waits until the peer has announced itself to us, which it does every three seconds."""
    backend = _node.node().backend
    while backend.name == "rclpy" and None in backend.participants([("peer", "/")]) or not known(backend):
        threading.Event().wait(0.02)


def known(backend):
    if backend.name != "rclpy":
        return True
    with backend.liveness._lock:
        return backend.participants([("peer", "/")]) <= set(backend.liveness._participants)


if __name__ == "__main__":
    unittest.main()
