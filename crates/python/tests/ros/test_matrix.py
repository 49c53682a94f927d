"""Each kind of message, quality of service, size and call, to and from a node of plain ``rclpy`` that says what it has heard.

The environment of the peer has what ``generate.py`` makes of ``types``. A line for each cell goes to the file ``RAFCON_ROS_TABLE``.
"""

import contextlib
import json
import math
import os
import random
import unittest

from peers import HERE, Peer, WithPeer
from plain import data, plain

from rafcon import ros
from rafcon.ros import _node

TO, FROM = "to the peer", "from the peer"
#: Types with all kinds of fields.
TYPES = [
    *(f"test_msgs/{name}" for name in ("BasicTypes", "Arrays", "BoundedSequences", "UnboundedSequences", "Strings", "WStrings")),
    *(f"test_msgs/{name}" for name in ("Nested", "MultiNested", "Defaults", "Empty", "Builtins")),
    *(f"odd_msgs/{name}" for name in ("Odd", "OddArrays", "Inner", "Empty")),
    "geometry_msgs/PoseWithCovarianceStamped",
    "sensor_msgs/PointCloud2",
]
#: More than a datagram of DDS carries, a picture, and what a helper must carry.
SIZES = (100, 70_000, 1_000_000, 10_000_000)
WAIT_S = 60
#: Characters that need one, two, three and four bytes of UTF-8.
LETTERS = "aZ 0ä€漢😀"
RANGES = {f"{sign}int{bits}": bits for sign in ("", "u") for bits in (8, 16, 32, 64)}


def value_of(field, dice, again):
    """A value for one element of a field."""
    if field.type == "bool":
        return dice.random() < 0.5
    if field.type in ("string", "wstring"):
        most = min(field.text_max or 12, 12)
        # Bounds count bytes, or units of UTF-16 of a wide text.
        letters = LETTERS if not field.text_max else LETTERS[:4] if field.type == "string" else LETTERS[:-1]
        return "".join(dice.choices(letters, k=dice.randint(0, most)))
    if field.type in ("byte", "char"):
        return dice.choice((0, 1, 127, 255))
    if field.type in RANGES:
        bits = RANGES[field.type]
        low, high = (0, 2**bits - 1) if field.type[0] == "u" else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
        return dice.choice((low, high, 0, 1, dice.randint(low, high)))
    if field.type in ("float32", "float64"):
        return dice.choice((0.0, -0.0, 1.5, -2.25, math.inf, -math.inf, math.nan, 3.0517578125e-05))
    return again(field.type)


def message_of(types, type_name, dice):
    """Values for all fields of a type."""
    again = lambda name: message_of(types, name, dice)  # noqa: E731
    values = {}
    for field in types.get(type_name).fields:
        count = {"fixed": field.size, "bounded": dice.randint(0, field.size), "unbounded": dice.randint(0, 4)}.get(field.kind)
        values[field.name] = value_of(field, dice, again) if count is None else [value_of(field, dice, again) for _ in range(count)]
    return values


def note(kind, direction, error):
    """Writes down a cell of the table."""
    file = os.environ.get("RAFCON_ROS_TABLE")
    if file:
        with open(file, "a", encoding="utf-8") as table:
            why = None if error is None else f"{type(error).__name__}: {error}"[:300]
            table.write(json.dumps({"kind": kind, "direction": direction, "why": why}) + "\n")


class Matrix(WithPeer):
    """Cells of the table in ``docs/ros.md``."""

    maxDiff = 4000

    @classmethod
    def setUpClass(cls):
        cls.peer = Peer("echo.py")
        cls.addClassCleanup(cls.peer.close)
        ros.configure(types=[str(HERE / "types")])
        cls.types = _node.node().types

    @contextlib.contextmanager
    def cell(self, kind, direction):
        """Runs a cell, and goes on after one that fails."""
        with self.subTest(kind=kind, direction=direction):
            try:
                yield
            except BaseException as error:
                note(kind, direction, error)
                raise
            note(kind, direction, None)

    def same(self, found, expected):
        """Compares by text, in which NaN is itself."""
        self.assertEqual(json.dumps(found), json.dumps(expected))


class Types(Matrix):
    def test_every_kind_of_field(self):
        for type_name in TYPES:
            full = type_name.replace("/", "/msg/")
            dice = random.Random(type_name)
            sent = [{}, *(message_of(self.types, full, dice) for _ in range(3))]
            expected = [plain(self.types.build(full, each)) for each in sent]
            topic = "/types/" + type_name.replace("/", "_").lower()
            with self.cell(type_name, TO):
                self.peer.hear(topic, full)
                for each in sent:
                    ros.publish(topic, each, type_name, wait=10)
                self.same(self.peer.heard(topic, len(sent)), expected)
            with self.cell(type_name, FROM), ros.subscribe(topic + "_back", type_name) as heard:
                self.peer.say(topic + "_back", full, [])
                self.peer.subscribers(topic + "_back", 1)
                self.peer.say(topic + "_back", full, [plain(each) for each in sent])
                self.same([plain(heard.next(WAIT_S).as_dict()) for _ in sent], expected)


class Qualities(Matrix):
    INT = "std_msgs/msg/Int32"

    def say(self, topic, numbers, **quality):
        self.peer.say(topic, self.INT, [{"data": number} for number in numbers], *quality.values())

    def test_in_order(self):
        for name, best_effort in (("reliable", False), ("best effort", True)):
            quality = ros.Qos("best_effort" if best_effort else "reliable", "volatile", 200)
            topic = "/qos/" + name.replace(" ", "_")
            count = 20 if best_effort else 200
            with self.cell(f"{count} messages, {name}", TO):
                self.peer.hear(topic, self.INT, False, best_effort, 200)
                heard, number = [], 0
                # Of best effort, those are lost that are sent before the peer knows the publisher.
                while number < count or best_effort and len(heard) < count:
                    ros.publish(topic, number, "std_msgs/Int32", qos=quality, wait=10)
                    number += 1
                    heard = self.peer.heard(topic, 0)
                found = [each["data"] for each in (heard if best_effort else self.peer.heard(topic, count))]
                self.assertEqual(found, sorted(set(found)) if best_effort else list(range(count)))
            topic += "_back"
            with self.cell(f"{count} messages, {name}", FROM), ros.subscribe(topic, "std_msgs/Int32", qos=quality) as heard:
                self.say(topic, [], latched=False, best_effort=best_effort, depth=200)
                self.peer.subscribers(topic, 1)
                if not best_effort:
                    self.say(topic, range(count))
                    self.same([heard.next(WAIT_S).data for _ in range(count)], list(range(count)))
                    continue
                found, number = [], 0
                while len(found) < count:
                    self.say(topic, [number])
                    number += 1
                    with contextlib.suppress(ros.TimedOut):
                        found.append(heard.next(0.05).data)
                self.assertEqual(found, sorted(set(found)))

    def test_latched(self):
        with self.cell("latched: the newest for who comes late", TO):
            for number in range(3):
                ros.publish("/qos/latched", number, "std_msgs/Int32", qos="latched", wait=0)
            self.peer.hear("/qos/latched", self.INT, True, False, 1)
            self.same(self.peer.heard("/qos/latched", 1), [{"data": 2}])
        with self.cell("latched: the newest for who comes late", FROM):
            self.say("/qos/latched_back", range(3), latched=True, best_effort=False, depth=1)
            for _ in range(2):
                self.assertEqual(ros.wait_for("/qos/latched_back", "std_msgs/Int32", timeout=20, qos="latched").data, 2)
            self.say("/qos/latched_back", [3])
            self.assertEqual(ros.wait_for("/qos/latched_back", "std_msgs/Int32", lambda each: each.data == 3, 20, qos="latched").data, 3)

    def test_what_was_sent_before_is_not_heard(self):
        with self.cell("volatile: nothing from before", TO):
            ros.publish("/qos/volatile", 1, "std_msgs/Int32", wait=0)
            # The helper has sent the message when it answers what comes after it.
            _node.node().backend.describe(self.INT)
            self.peer.hear("/qos/volatile", self.INT)
            heard = self.peer.heard
            ros.publish("/qos/volatile", 0, "std_msgs/Int32", wait=0)
            # The peer is matched once a message has come.
            number = 2
            while not heard("/qos/volatile", 0):
                ros.publish("/qos/volatile", number, "std_msgs/Int32", wait=0)
                number += 1
            self.assertNotEqual(heard("/qos/volatile", 1)[0], {"data": 1})
        with self.cell("volatile: nothing from before", FROM):
            self.say("/qos/old", [])
            with ros.subscribe("/qos/old", "std_msgs/Int32") as heard:
                self.peer.subscribers("/qos/old", 1)
                self.say("/qos/old", (1, 2, 3))
                self.assertEqual([heard.next(WAIT_S).data for _ in range(3)], [1, 2, 3])
            for _ in range(3):
                with self.assertRaises(ros.TimedOut):
                    ros.wait_for("/qos/old", "std_msgs/Int32", timeout=0.5)
            called = []
            with ros.subscribe("/qos/old", "std_msgs/Int32", lambda message: called.append(message.data)):
                self.assertIsNone(ros.latest("/qos/old", "std_msgs/Int32", timeout=0.5))
            self.assertEqual(called, [])

    def test_the_newest(self):
        with self.cell("latest: the newest", FROM):
            self.say("/qos/newest", [])
            with ros.subscribe("/qos/newest", "std_msgs/Int32") as heard:
                self.peer.subscribers("/qos/newest", 1)
                self.say("/qos/newest", (1, 2, 3))
                for _ in range(3):
                    heard.next(WAIT_S)
                self.assertIsNone(ros.latest("/qos/newest", "std_msgs/Int32", timeout=0.2))
                self.peer.subscribers("/qos/newest", 2)
                self.say("/qos/newest", (4, 5))
                for _ in range(2):
                    heard.next(WAIT_S)
                while ros.latest("/qos/newest", "std_msgs/Int32").data != 5:
                    self.assertIn(ros.latest("/qos/newest", "std_msgs/Int32").data, (4, 5))


class Sizes(Matrix):
    TYPE = "std_msgs/msg/UInt8MultiArray"

    def test_topics(self):
        for size in SIZES:
            expected = {"layout": {"dim": [], "data_offset": 0}, "data": plain(data(size))}
            topic = f"/sizes/topic_{size}"
            with self.cell(f"topic of {size:,} bytes", TO):
                self.peer.hear(topic, self.TYPE)
                ros.publish(topic, {"data": data(size)}, "std_msgs/UInt8MultiArray", wait=10)
                self.same(self.peer.heard(topic, 1), [expected])
            topic += "_back"
            with self.cell(f"topic of {size:,} bytes", FROM), ros.subscribe(topic, "std_msgs/UInt8MultiArray") as heard:
                self.peer.say(topic, self.TYPE, [])
                self.peer.subscribers(topic, 1)
                self.peer.say(topic, self.TYPE, [{"data": {"bytes": size}}])
                self.same(plain(heard.next(WAIT_S).as_dict()), expected)

    def test_services(self):
        self.peer.serve("/sizes/there", "odd_msgs/srv/Carry")
        echo = lambda request: request.as_dict()  # noqa: E731
        with ros.serve("/sizes/here", echo, "odd_msgs/Carry"):
            # A small one at the end: one that is lost must not block the next.
            for size in (*SIZES, 10):
                expected = {"data": plain(data(size)), "text": "ä" * size if size < 2_000_000 else "", "wide": "漢😀"}
                request = {**expected, "data": data(size)}
                with self.cell(f"request and response of {size:,} bytes", TO):
                    answer = ros.call("/sizes/there", request, "odd_msgs/Carry", timeout=WAIT_S, find=20)
                    self.same(plain(answer.as_dict()), expected)
                with self.cell(f"request and response of {size:,} bytes", FROM):
                    self.same(self.peer.call("/sizes/here", "odd_msgs/srv/Carry", {**expected, "data": {"bytes": size}}), expected)

    def test_actions(self):
        self.peer.act("/sizes/act_there", "odd_msgs/action/Blob")

        def work(goal):
            for _ in range(goal.goal.feedbacks):
                goal.feedback(data=data(goal.goal.size))
            return {"data": bytes(goal.goal.data)}

        with ros.action_server("/sizes/act_here", work, "odd_msgs/Blob"):
            for size in (*SIZES, 10):
                kind, long = f"goal, feedback and result of {size:,} bytes", plain(data(size))
                with self.cell(kind, TO):
                    goal = {"data": data(size), "feedbacks": 2, "size": size}
                    told = []
                    ended = ros.action("/sizes/act_there", goal, "odd_msgs/Blob", timeout=WAIT_S, find=20, accept=WAIT_S, feedback=told.append)
                    self.assertEqual((ended.outcome, ended.why), ("succeeded", ""))
                    self.same(plain(ended.result.as_dict()), {"data": long})
                    # rclpy may send the result before feedback that came first.
                    self.assertLessEqual({plain(each.as_dict())["data"] if size > 4096 else bytes(each.data).hex() for each in told}, {long if size > 4096 else data(size).hex()})
                with self.cell(kind, FROM):
                    goal = {"data": {"bytes": size}, "feedbacks": 2, "size": size}
                    self.same(self.peer.goal("/sizes/act_here", "odd_msgs/action/Blob", goal, 2), [4, {"data": long}, [{"data": long}] * 2])


class Others(Matrix):
    def test_parameters(self):
        for name, value in (("flag", True), ("count", -3), ("speed", 0.25), ("label", "ä€😀"), ("raw", b"\0\xff"), ("flags", [True, False]), ("counts", [1, -(2**63)]), ("speeds", [0.5, 1e300]), ("labels", ["", "b"])):
            with self.cell(f"parameter: {type(value).__name__}{' of ' + type(value[0]).__name__ if isinstance(value, list) else ''}", TO):
                ros.param_set("/echo", name, value)
                self.same(plain(ros.param_get("/echo", name)), plain(value))

    def test_transforms(self):
        def at(child, parent, x, sec):
            where = {"translation": {"x": x, "y": 0.0, "z": 0.0}, "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}
            return {"transforms": [{"header": {"stamp": {"sec": sec, "nanosec": 0}, "frame_id": parent}, "child_frame_id": child, "transform": where}]}

        with self.cell("transform: static, then dynamic", FROM):
            self.peer.say("/tf_static", "tf2_msgs/msg/TFMessage", [at("base", "odom", 1.5, 0)], True, False, 1)
            self.peer.say("/tf", "tf2_msgs/msg/TFMessage", [])
            self.assertEqual(ros.transform("odom", "base", timeout=20).translation[0], 1.5)
            self.peer.subscribers("/tf", 1)
            self.peer.say("/tf", "tf2_msgs/msg/TFMessage", [at("odom", "map", 1.0, 10), at("odom", "map", 3.0, 12)])
            self.assertEqual(ros.transform("map", "base", time=11.0, timeout=20).translation[0], 3.5)

    def test_failures(self):
        with self.cell("a server that is missing", TO), self.assertRaises(ros.NoServer):
            ros.call("/others/nobody", {}, "std_srvs/Trigger", find=0.2)
        with self.cell("a server that dies", TO):
            other = Peer("peer.py")
            waiting = self.later(lambda: self.outcome("/peer/never"))
            other.counted("never called")
            other.kill()
            self.assertEqual(waiting(), "the service /peer/never: its server has ended")

    @staticmethod
    def outcome(service):
        try:
            return ros.call(service, {}, "std_srvs/Trigger", timeout=60, find=20)
        except ros.NoServer as error:
            return str(error)


if __name__ == "__main__":
    unittest.main()
