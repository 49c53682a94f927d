"""The buffer of transforms, against what can be worked out by hand."""

import math
import random
import unittest

import stage  # noqa: F401, it brings the package
from rafcon.ros._transform_buffer import Buffer, NoTransform

NS = 1_000_000_000
NO_TURN = (0.0, 0.0, 0.0, 1.0)


def about_z(angle):
    return (0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2))


class Buffers(unittest.TestCase):
    def setUp(self):
        self.buffer = Buffer()

    def add(self, child, parent, stamp=None, at=(0, 0, 0), turn=NO_TURN):
        static = stamp is None
        return self.buffer.add(child, parent, 0 if static else round(stamp * NS), at, turn, static)

    def find(self, target, source, stamp=None):
        return self.buffer.find(target, source, None if stamp is None else round(stamp * NS))

    def same(self, found, expected):
        for one, two in zip(found, expected):
            self.assertAlmostEqual(one, two)

    def refused(self, text, *arguments):
        with self.assertRaises(NoTransform) as caught:
            self.find(*arguments)
        self.assertEqual(str(caught.exception), text)

    def tree(self):
        """map → odom → base → camera, and map → dock."""
        self.add("odom", "map", 1, (1, 0, 0))
        self.add("base", "odom", 1, (0, 2, 0), about_z(math.pi / 2))
        self.add("camera", "base", None, (1, 0, 0))
        self.add("dock", "map", None, (5, 5, 0))

    def test_along_a_line(self):
        self.tree()
        found = self.find("map", "camera")
        self.same(found.translation, (1, 3, 0))
        self.assertAlmostEqual(found.yaw(), math.pi / 2)
        self.same(found.apply((1, 0, 0)), (1, 4, 0))
        self.same(found.inverse().apply((1, 4, 0)), (1, 0, 0))
        self.assertEqual(found.stamp, 1.0)

    def test_across_the_tree(self):
        self.tree()
        self.same(self.find("camera", "dock").apply((0, 0, 0)), (2, -4, 0))
        self.same(self.find("dock", "camera").apply((2, -4, 0)), (0, 0, 0))
        self.same(self.find("base", "base").translation, (0, 0, 0))

    def test_a_matrix_does_the_same(self):
        self.tree()
        found = self.find("dock", "camera")
        point = (0.3, -2.0, 7.0)
        self.same([sum(a * b for a, b in zip(row, (*point, 1))) for row in found.matrix()][:3], found.apply(point))

    def test_between_two_times(self):
        self.add("a", "w", 1, (0, 0, 0))
        self.add("a", "w", 3, (4, 0, 0), about_z(1))
        found = self.find("w", "a", 1.5)
        self.same(found.translation, (1, 0, 0))
        self.assertAlmostEqual(found.yaw(), 0.25)
        self.same(self.find("w", "a", 3).translation, (4, 0, 0))
        self.refused("the newest transform of a is 0.500 s older than the time that is asked for", "w", "a", 3.5)
        self.refused("the oldest transform of a is 0.500 s newer than the time that is asked for", "w", "a", 0.5)

    def test_the_newest_that_all_have(self):
        self.add("a", "w", 1)
        self.add("a", "w", 4, (3, 0, 0))
        self.add("b", "a", 2)
        self.assertEqual(self.find("w", "b").stamp, 2.0)
        self.same(self.find("w", "b").translation, (1, 0, 0))

    def test_what_comes_late_is_put_in_order(self):
        for stamp in (3, 1, 2, 2):
            self.add("a", "w", stamp, (stamp, 0, 0))
        self.same(self.find("w", "a", 1.5).translation, (1.5, 0, 0))

    def test_what_is_old_is_forgotten(self):
        for stamp in range(1, 30):
            self.add("a", "w", stamp)
        self.refused("the oldest transform of a is 16.000 s newer than the time that is asked for", "w", "a", 3)

    def test_a_simulation_that_begins_anew(self):
        self.add("fixed", "w", None)
        self.add("a", "w", 1000, (1, 0, 0))
        self.add("b", "w", 1, (2, 0, 0))
        self.assertEqual(self.buffer.frames(), ["b", "fixed", "w"])

    def test_what_makes_no_sense_is_left_out(self):
        for at, turn in (((math.nan, 0, 0), NO_TURN), ((0, 0, 0), (0, 0, 0, 0)), ((0, 0, 0), (math.inf, 0, 0, 1))):
            self.assertFalse(self.add("a", "w", 1, at, turn))
        self.assertFalse(self.add("a", "/a", 1))
        self.assertFalse(self.add("", "w", 1))
        self.assertEqual(self.buffer.frames(), [])

    def test_no_way(self):
        self.refused("there is no frame 'map'; known are none", "map", "base")
        self.tree()
        self.add("x", "y", 1)
        self.refused("x hangs below y and map below map: the two trees are not connected", "map", "x")
        self.refused("there is no frame 'bose'; known are base, camera, dock, map, odom, x, y", "map", "bose")
        self.add("y", "x", 1)
        self.refused("the frames x → y → x go round in a circle", "map", "x")

    def test_a_frame_below_too_many_others_is_refused_and_the_others_are_found(self):
        for number in range(1, 1001):
            self.add(f"f{number}", f"f{number - 1}", None, (1, 0, 0))
        self.same(self.find("f0", "f999").translation, (999, 0, 0))
        self.refused("more than 999 frames lie above f1000, the last of them f1", "f0", "f1000")
        self.refused("more than 999 frames lie above f1000, the last of them f1", "f1000", "f0")
        self.same(self.find("f1", "f1000").translation, (999, 0, 0))

    def test_ways_there_and_back_agree(self):
        """Any tree, any turns: the way through a third frame is the direct one."""
        numbers = random.Random(7)
        for child in range(1, 30):
            turn = [numbers.gauss(0, 1) for _ in range(4)]
            at = [numbers.gauss(0, 5) for _ in range(3)]
            self.add(f"f{child}", f"f{numbers.randrange(child)}", None if child % 3 else 1, at, turn)
        for _ in range(200):
            a, b, c = (f"f{numbers.randrange(30)}" for _ in range(3))
            point = [numbers.gauss(0, 5) for _ in range(3)]
            self.same(self.find(a, c).apply(point), self.find(a, b).apply(self.find(b, c).apply(point)))


if __name__ == "__main__":
    unittest.main()
