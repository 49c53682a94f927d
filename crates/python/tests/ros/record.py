"""Prints messages as ``rclpy`` sends them, for the tests of ``rafcon-ros``: type, bytes of CDR, and the message as JSON, line by line.

``python record.py``, with a Python that has ``rclpy`` and what ``generate.py`` makes of ``types``.
"""

import importlib
import json
import math

import rclpy
from plain import filled, of_rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile

INNER = {"a": -1, "b": 0.5, "c": "ä"}
STAMP = {"sec": -7, "nanosec": 999_999_999}
MESSAGES = [
    ("odd_msgs/msg/Empty", {}),
    ("odd_msgs/msg/Inner", INNER),
    ("odd_msgs/msg/Odd", {}),
    (
        "odd_msgs/msg/Odd",
        {
            **{"flag": False, "raw": 255, "letter": 65, "i8": 127, "u8": 0, "i16": -32768, "u16": 65535, "i32": 2147483647, "u32": 4294967295},
            **{"i64": 9223372036854775807, "u64": 1, "f32": -math.inf, "f64": math.nan, "text": "", "brief": "abcde", "wide": "a漢😀", "wide_brief": "äß"},
            **{"inner": INNER, "stamp": STAMP},
        },
    ),
    ("odd_msgs/msg/OddArrays", {}),
    (
        "odd_msgs/msg/OddArrays",
        {
            **{"flags": [True, False, True], "raw": [0, 255], "letters": [65], "i8": [-1], "u16": [1, 65535], "i32": [7], "u64": [2**64 - 1]},
            **{"f32": [1.5], "f64": [-0.0, 1e300], "texts": ["", "ä"], "brief_texts": ["abc"], "two_texts": ["x", "yz"], "wides": ["", "😀"]},
            **{"inners": [INNER, INNER], "two_inners": [INNER, {}], "some_inners": [INNER], "nothings": [{}, {}], "durations": [STAMP], "last": 5},
        },
    ),
    ("sensor_msgs/msg/PointCloud2", {"height": 1, "fields": [{"name": "x", "offset": 4, "datatype": 7, "count": 1}], "data": b"\x01\x02\x03", "is_dense": True}),
    ("rcl_interfaces/msg/ParameterValue", {"type": 9, "string_array_value": ["a", "", "ä"], "bool_value": True, "double_array_value": [1.5]}),
]


def main():
    rclpy.init()
    node = rclpy.create_node("record")
    for number, (type_name, values) in enumerate(MESSAGES):
        package, kind, name = type_name.split("/")
        cls = getattr(importlib.import_module(f"{package}.{kind}"), name)
        quality = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        heard = []
        node.create_subscription(cls, f"record{number}", heard.append, quality, raw=True)
        message = filled(cls(), values)
        node.create_publisher(cls, f"record{number}", quality).publish(message)
        while not heard:
            rclpy.spin_once(node, timeout_sec=1)
        # The first four bytes say that it is CDR, least byte first.
        print(type_name, heard[0][4:].hex() or "-", json.dumps(of_rclpy(message), ensure_ascii=False))
    rclpy.shutdown()


if __name__ == "__main__":
    main()
