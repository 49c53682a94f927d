"""Points, angles and boxes in the plane."""

import math
from math import pi  # noqa: F401, part of this module as of old


def deg2rad(degree):
    """Convert degrees to radians."""
    return math.radians(degree)


def dist(p1, p2):
    """Distance between two points."""
    return math.hypot(p1[0] - p2[0], p1[1] - p2[1])


def equal(t1, t2, digit=None):
    """True if two tuples are equal, with ``digit`` after rounding to that number of digits."""
    if len(t1) != len(t2):
        return False
    if digit is None:
        return all(a == b for a, b in zip(t1, t2))
    return all(round(a, digit) == round(b, digit) for a, b in zip(t1, t2))


def point_left_of_line(point, line_start, line_end):
    """True if a point is on the left of a line; y points downwards, as on a screen."""
    along = (line_end[0] - line_start[0], line_end[1] - line_start[1])
    to_point = (point[0] - line_start[0], point[1] - line_start[1])
    return along[0] * to_point[1] - along[1] * to_point[0] < 0


def cal_dist_between_2_coord_frame_aligned_boxes(box1_pos, box1_size, box2_pos, box2_size):
    """Distance between two boxes, each a corner and a size; 0 if they touch or overlap."""
    gaps = [
        max(first - (second + length), second - (first + width), 0)
        for first, width, second, length in zip(box1_pos, box1_size, box2_pos, box2_size)
    ]
    return math.hypot(*gaps)
