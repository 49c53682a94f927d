"""Messages of ``rafcon.ros`` by a table of types: what fits, what does not and what is said of it."""

import array
import copy
import math
import pickle
import struct
import unittest

import stage  # noqa: F401, it brings the package
from rafcon.ros import _types
from rafcon.ros._backend import Field, MessageType, RosError, UnknownType
from rafcon.ros._message import Message
from rafcon.ros._types import Types, absolute, full_name

POINT = MessageType("p/msg/Point", (Field("x", "float64"), Field("y", "float64", default=1.5)))
ALL = MessageType(
    "p/msg/All",
    (
        Field("flag", "bool"),
        Field("small", "int8"),
        Field("large", "uint64"),
        Field("single", "float32"),
        Field("name", "string", default="none"),
        Field("short", "string", text_max=3),
        Field("wide", "wstring", text_max=2),
        Field("data", "uint8", "unbounded"),
        Field("pair", "float64", "fixed", 2, default=array.array("d", [1.0, 2.0])),
        Field("few", "int32", "bounded", 2),
        Field("flags", "bool", "fixed", 2),
        Field("words", "string", "unbounded"),
        Field("point", "p/msg/Point"),
        Field("points", "p/msg/Point", "unbounded"),
        Field("values", "float32", "unbounded"),
    ),
    {"MOST": 7},
)
ONE = MessageType("p/msg/One", (Field("data", "string"),))
NONE = MessageType("p/srv/Do_Request", ())


def types():
    known = Types(_unknown)
    known.learn({each.name: each for each in (POINT, ALL, ONE, NONE)})
    return known


def _unknown(name):
    raise UnknownType(f"there is no type {name}")


class Index:
    def __index__(self):
        return 5


class Built(unittest.TestCase):
    def setUp(self):
        self.types = types()

    def build(self, value, name="p/msg/All"):
        return self.types.build(name, value)

    def refused(self, value, text, name="p/msg/All"):
        with self.assertRaises(RosError) as caught:
            self.build(value, name)
        self.assertEqual(str(caught.exception), text)

    def test_nothing_given_is_what_the_type_says(self):
        found = self.build(None)
        self.assertEqual(list(found), [field.name for field in ALL.fields])
        self.assertEqual((found["flag"], found["large"], found["name"], found["wide"]), (False, 0, "none", ""))
        self.assertEqual((found["data"], found["pair"], found["few"]), (b"", array.array("d", [1, 2]), array.array("i")))
        self.assertEqual((found["flags"], found["point"], found["points"]), ([False, False], {"x": 0.0, "y": 1.5}, []))
        found["pair"][0] = 9
        self.assertEqual(self.build(None)["pair"], array.array("d", [1, 2]))

    def test_values_become_those_of_the_type(self):
        given = {
            "flag": True,
            "small": Index(),
            "large": 2**64 - 1,
            "single": 3,
            "short": "äb",
            "data": [1, 2],
            "pair": (math.nan, math.inf),
            "few": array.array("i", [1, 2]),
            "words": ("a", "b"),
            "point": {"x": 1},
            "points": [{"y": 2}],
            "values": memoryview(array.array("f", [0.5])),
        }
        found = self.build(given)
        self.assertEqual((found["small"], found["large"], found["single"], found["data"]), (5, 2**64 - 1, 3.0, b"\x01\x02"))
        self.assertEqual((str(found["pair"][0]), found["pair"][1], found["few"]), ("nan", math.inf, array.array("i", [1, 2])))
        self.assertEqual((found["words"], found["points"]), (["a", "b"], [{"x": 0.0, "y": 2.0}]))
        self.assertEqual(found["values"], array.array("f", [0.5]))
        self.assertIs(type(found["single"]), float)

    def test_a_type_with_one_field_takes_its_value(self):
        self.assertEqual(self.build("hello", "p/msg/One"), {"data": "hello"})
        self.assertEqual(self.build(None, "p/srv/Do_Request"), {})
        self.refused("hello", "p/srv/Do_Request: a message with the fields none is expected, not 'hello' (str)", "p/srv/Do_Request")

    def test_what_does_not_fit_is_named(self):
        for value, text in (
            ({"small": 128}, "p/msg/All.small: int8 (-128 to 127) is expected, not 128 (int)"),
            ({"small": True}, "p/msg/All.small: int8 is expected, not True (bool)"),
            ({"small": 1.0}, "p/msg/All.small: int8 is expected, not 1.0 (float)"),
            ({"large": -1}, "p/msg/All.large: uint64 (0 to 18446744073709551615) is expected, not -1 (int)"),
            ({"single": "1"}, "p/msg/All.single: float32 is expected, not '1' (str)"),
            ({"single": 1e39}, "p/msg/All.single: float32 (up to 3.4e38) is expected, not 1e+39 (float)"),
            ({"flag": 1}, "p/msg/All.flag: bool is expected, not 1 (int)"),
            ({"name": b"x"}, "p/msg/All.name: string is expected, not b'x' (bytes)"),
            ({"name": "\ud800"}, "p/msg/All.name: a text without half characters is expected, not '\\ud800' (str)"),
            ({"short": "äää"}, "p/msg/All.short: up to 3 characters are expected, not 6"),
            ({"data": [256]}, "p/msg/All.data[0]: uint8 (0 to 255) is expected, not 256 (int)"),
            ({"data": "ab"}, "p/msg/All.data: uint8[] is expected, not 'ab' (str)"),
            ({"pair": [1]}, "p/msg/All.pair: 2 values are expected, not 1 (float64[2])"),
            ({"few": [1, 2, 3]}, "p/msg/All.few: up to 2 values are expected, not 3 (int32[<=2])"),
            ({"few": [1, "x"]}, "p/msg/All.few[1]: int32 is expected, not 'x' (str)"),
            ({"words": "ab"}, "p/msg/All.words: string[] is expected, not 'ab' (str)"),
            ({"points": [{}, {"x": None}]}, "p/msg/All.points[1].x: float64 is expected, not None (NoneType)"),
            ({"point": {"z": 1}}, "p/msg/All.point has no field 'z'; it has x, y"),
            ({"nmae": "x"}, "p/msg/All has no field 'nmae'; is name meant?"),
            (5, "p/msg/All: a message with the fields " + ", ".join(field.name for field in ALL.fields) + " is expected, not 5 (int)"),
        ):
            with self.subTest(text):
                self.refused(value, text)

    def test_a_number_too_large_for_32_bits_is_refused(self):
        most = 3.4028235677973366e38
        for sign in (1, -1):
            self.assertEqual(self.build({"single": sign * most})["single"], sign * most)
            with self.assertRaisesRegex(RosError, r"single: float32 \(up to 3.4e38\) is expected"):
                self.build({"single": sign * math.nextafter(most, math.inf)})
        self.assertEqual(self.build({"single": math.inf})["single"], math.inf)

    def test_of_a_long_value_that_does_not_fit_the_beginning_is_shown(self):
        self.refused({"small": "x" * 58}, f"p/msg/All.small: int8 is expected, not '{'x' * 58}' (str)")
        self.refused({"small": "x" * 59}, f"p/msg/All.small: int8 is expected, not '{'x' * 59}… (str)")

    def test_a_message_of_another_type_is_refused(self):
        point = Message.of("p/msg/Point", self.types, self.build({}, "p/msg/Point"))
        self.assertEqual(self.build({"point": point})["point"], {"x": 0.0, "y": 1.5})
        self.refused(point, "p/msg/All: a message of the type p/msg/All is expected, not of p/msg/Point")

    def test_numpy(self):
        try:
            import numpy
        except ImportError:
            self.skipTest("needs numpy")
        found = self.build({"pair": numpy.array([1.0, 2.0]), "few": numpy.array([1, 2]), "flag": numpy.bool_(True), "small": numpy.int64(3)})
        self.assertEqual((found["pair"], found["few"]), (array.array("d", [1, 2]), array.array("i", [1, 2])))
        self.assertEqual((found["flag"], found["small"]), (True, 3))
        self.assertEqual(self.build({"data": numpy.arange(3, dtype="uint8")})["data"], b"\0\1\2")


class Messages(unittest.TestCase):
    def setUp(self):
        self.types = types()
        self.message = self.of("p/msg/All", {"points": [{"x": 1}], "values": [1]})

    def of(self, name, value):
        return Message.of(name, self.types, self.types.build(name, value))

    def test_fields_are_attributes_and_keys(self):
        self.message.point.x = 3
        self.message["points"][0].y = 4
        self.message.name = "new"
        self.assertEqual((self.message.point["x"], self.message.points[0]["y"], self.message["name"]), (3.0, 4.0, "new"))
        self.assertEqual(self.message.as_dict()["point"], {"x": 3.0, "y": 1.5})
        self.assertEqual(self.types.build("p/msg/All", self.message)["points"], [{"x": 1.0, "y": 4.0}])

    def test_fields_come_before_methods(self):
        self.assertEqual(self.message.values, array.array("f", [1]))
        self.assertEqual(dict(self.message.items())["name"], "none")

    def test_a_wrong_value_is_refused_at_once(self):
        with self.assertRaisesRegex(ValueError, r"p/msg/Point.x: float64 is expected, not 'a' \(str\)"):
            self.message.point.x = "a"
        with self.assertRaisesRegex(AttributeError, "p/msg/Point has no field 'z'; it has x, y"):
            self.message.point.z = 1
        with self.assertRaisesRegex(AttributeError, "p/msg/Point has no field 'z'; it has x, y"):
            self.message.point.z  # noqa: B018, the access is the test

    def test_constants(self):
        self.assertEqual(self.message.MOST, 7)

    def test_copies_and_pickles_stand_by_themselves(self):
        for other in (copy.deepcopy(self.message), pickle.loads(pickle.dumps(self.message))):
            self.assertEqual(other, self.message)
            other.point.x = 9
            self.assertNotEqual(other, self.message)
            with self.assertRaises(RosError):
                other.point.x = None

    def test_it_is_shown(self):
        self.assertEqual(repr(self.of("p/msg/Point", {"x": 1})), "p/msg/Point(x=1.0, y=1.5)")
        long = self.of("p/msg/All", {"data": bytes(1000)})
        self.assertIn("data=[0, 0, 0, 0, 0, 0, 0, 0, … 1000 in all]", repr(long))

    def test_of_a_long_array_the_first_items_are_shown(self):
        for count, shown in ((8, "[0, 0, 0, 0, 0, 0, 0, 0]"), (9, "[0, 0, 0, 0, 0, 0, 0, 0, … 9 in all]")):
            self.assertIn(f"data={shown}", repr(self.of("p/msg/All", {"data": bytes(count)})))


class Names(unittest.TestCase):
    def test_types(self):
        for name in ("geometry_msgs/Twist", "geometry_msgs/msg/Twist", "geometry_msgs.msg.Twist", "geometry_msgs::msg::Twist"):
            self.assertEqual(full_name(name), "geometry_msgs/msg/Twist")
        self.assertEqual(full_name("std_srvs/Trigger", "srv"), "std_srvs/srv/Trigger")
        for name in ("Twist", "a/b/c", "a/srv/B", "", "a/msg/b/c"):
            with self.assertRaises(UnknownType):
                full_name(name)
        with self.assertRaises(UnknownType):
            full_name(dict)

    def test_topics(self):
        self.assertEqual([absolute(name, "/robot") for name in ("/scan", "scan", "a/b")], ["/scan", "/robot/scan", "/robot/a/b"])
        for name in ("", "/", "/a b", "/1a", "/a//b", "/ä", None):
            with self.assertRaises(RosError):
                absolute(name)

    def test_a_type_that_holds_others_is_closed(self):
        self.assertEqual(sorted(types().closure("p/msg/All")), ["p/msg/All", "p/msg/Point"])
        with self.assertRaises(UnknownType):
            types().closure("p/msg/Other")
        self.assertTrue(_types.is_ros_object(type("T", (), {"get_fields_and_field_types": 1})()))


class Participants(unittest.TestCase):
    """What is read of an announcement (RTPS 2.2, 8.5.3)."""

    KEY = bytes(range(1, 13))

    def announcement(self, order="<", writer=0x000100C2):
        def parameter(number, value):
            return struct.pack(order + "HH", number, len(value)) + value

        place = struct.pack(order + "iI", 1, 7411) + bytes(12) + bytes((127, 0, 0, 1))
        other = struct.pack(order + "iI", 2, 7411) + bytes(16)
        found = b"\0\3\0\0" if order == "<" else b"\0\2\0\0"
        found += parameter(0x50, self.KEY + b"\0\0\1\xc1") + parameter(0x32, place) + parameter(0x32, other) + parameter(1, b"")
        body = struct.pack(order + "HH", 0, 16) + bytes(4) + struct.pack(">I", writer) + bytes(8) + found
        return b"RTPS\2\2\1\x0f" + self.KEY + bytes((0x15, 5 if order == "<" else 4)) + struct.pack(order + "H", len(body)) + body

    def test_an_announcement_says_where_a_participant_is(self):
        from rafcon.ros._liveness import announced

        for order in "<>":
            self.assertEqual(announced(self.announcement(order)), (self.KEY, (("127.0.0.1", 7411),)))
        self.assertIsNone(announced(self.announcement(writer=0x000003C2)))

    def test_anything_else_is_nothing(self):
        from rafcon.ros._liveness import announced

        whole = self.announcement()
        for content in (b"", b"RTPS", bytes(100), *(whole[:length] for length in range(len(whole) - 40))):
            self.assertIsNone(announced(content))
        for at in range(20, len(whole)):
            announced(whole[:at] + b"\xff" + whole[at + 1 :])


if __name__ == "__main__":
    unittest.main()
