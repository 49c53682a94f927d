"""Buffer of transforms: a tree of frames over time, and paths between frames (like ``tf2``)."""

import bisect
import math
import threading
from dataclasses import dataclass

#: Maximum age (ns) of transforms, relative to the newest of their frame.
_KEPT_NS = 10_000_000_000
#: A jump back in time by more than this (ns) is a restarted simulation; all transforms are then dropped.
_JUMP_NS = 1_000_000_000
#: Maximum number of frames from a frame up to its root, including itself.
_DEPTH_MAX = 1000


class NoTransform(Exception):
    """There is no path between two frames (yet); the message gives the reason."""


@dataclass(frozen=True)
class Transform:
    """Pose of ``source`` in ``target``; converts points of ``source`` to points of ``target``."""

    target: str
    source: str
    #: (x, y, z)
    translation: tuple
    #: A unit quaternion (x, y, z, w).
    rotation: tuple
    #: Time (s) of the transform; 0 if no part of it ever moves.
    stamp: float = 0.0

    def apply(self, point):
        """Convert a point (x, y, z) of ``source`` to a point of ``target``."""
        return tuple(a + b for a, b in zip(_turned(self.rotation, tuple(point)), self.translation))

    def inverse(self):
        """Inverse transform."""
        back = _conjugate(self.rotation)
        moved = tuple(-each for each in _turned(back, self.translation))
        return Transform(self.source, self.target, moved, back, self.stamp)

    def matrix(self):
        """Homogeneous matrix: four rows of four numbers."""
        x, y, z, w = self.rotation
        rows = (
            (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
            (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
            (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
        )
        return tuple((*row, moved) for row, moved in zip(rows, self.translation)) + ((0.0, 0.0, 0.0, 1.0),)

    def yaw(self):
        """Rotation about the z axis, in radians."""
        x, y, z, w = self.rotation
        return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))

    def as_dict(self):
        """Values by name."""
        return {
            "target": self.target,
            "source": self.source,
            "translation": self.translation,
            "rotation": self.rotation,
            "stamp": self.stamp,
        }


class Buffer:
    """Received transforms; thread-safe."""

    def __init__(self):
        self._lock = threading.Lock()
        self._frames = {}
        self._newest_ns = 0

    def add(self, child, parent, stamp_ns, translation, rotation, static):
        """Add a transform; False if it is invalid.

        Invalid are values that are not finite, rotations of length 0, frames without a name, and a
        frame as its own parent.
        """
        child, parent = _frame(child), _frame(parent)
        numbers = (*translation, *rotation)
        length = math.sqrt(sum(each * each for each in rotation))
        if not child or not parent or child == parent or not all(map(math.isfinite, numbers)) or length < 1e-6:
            return False
        sample = stamp_ns, parent, tuple(translation), tuple(each / length for each in rotation)
        with self._lock:
            self._forget_after_jump(stamp_ns, static)
            line = self._frames.get(child)
            if line is None or line.static != static:
                line = self._frames[child] = _Line(static)
            line.add(sample)
        return True

    def _forget_after_jump(self, stamp_ns, static):
        if static:
            return
        if stamp_ns < self._newest_ns - _KEPT_NS - _JUMP_NS:
            self._frames = {name: line for name, line in self._frames.items() if line.static}
            self._newest_ns = stamp_ns
        self._newest_ns = max(self._newest_ns, stamp_ns)

    def frames(self):
        """Names of all frames."""
        with self._lock:
            parents = {sample[1] for line in self._frames.values() for sample in line.samples}
            return sorted(parents | set(self._frames))

    def find(self, target, source, stamp_ns=None):
        """Transform at a time, by default the newest common time of all frames on the path.

        Raises :class:`NoTransform`.
        """
        target, source = _frame(target), _frame(source)
        with self._lock:
            if target == source:
                return Transform(target, source, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), (stamp_ns or 0) / 1e9)
            common = self._common_ns(target, source) if stamp_ns is None else stamp_ns
            up, down = self._ways(target, source, common)
            translation, rotation = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)
            for frame in up:
                translation, rotation = _then(self._frames[frame].at(frame, common), translation, rotation)
            if down:
                back = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)
                for frame in down:
                    back = _then(self._frames[frame].at(frame, common), *back)
                turn = _conjugate(back[1])
                translation = _turned(turn, tuple(a - b for a, b in zip(translation, back[0])))
                rotation = _product(turn, rotation)
        return Transform(target, source, translation, rotation, (common or 0) / 1e9)

    def _ways(self, target, source, stamp_ns):
        """Frames from the source, and from the target, up to their common frame."""
        above_source, above_target = self._line_up(source, stamp_ns), self._line_up(target, stamp_ns)
        met = next((frame for frame in above_source if frame in above_target), None)
        if met is None:
            raise NoTransform(self._why_apart(target, source, above_target, above_source))
        return above_source[: above_source.index(met)], above_target[: above_target.index(met)]

    def _line_up(self, frame, stamp_ns):
        line = [frame]
        while line[-1] in self._frames and len(line) < _DEPTH_MAX:
            parent = self._frames[line[-1]].parent(stamp_ns)
            if parent in line:
                raise NoTransform(f"the frames {' → '.join([*line, parent])} go round in a circle")
            line.append(parent)
        return line

    def _why_apart(self, target, source, above_target, above_source):
        known = set(self._frames) | {sample[1] for line in self._frames.values() for sample in line.samples}
        for frame in (target, source):
            if frame not in known:
                return f"there is no frame {frame!r}; known are {', '.join(sorted(known)) or 'none'}"
        for frame, above in ((source, above_source), (target, above_target)):
            if len(above) == _DEPTH_MAX and above[-1] in self._frames:
                return f"more than {_DEPTH_MAX - 1} frames lie above {frame}, the last of them {above[-1]}"
        return f"{source} hangs below {above_source[-1]} and {target} below {above_target[-1]}: the two trees are not connected"

    def _common_ns(self, target, source):
        up, down = self._ways(target, source, None)
        moving = [self._frames[frame].samples[-1][0] for frame in up + down if not self._frames[frame].static]
        return min(moving, default=None)


class _Line:
    """Transforms of one frame to its parent, by time."""

    def __init__(self, static):
        self.static = static
        self.samples = []

    def add(self, sample):
        """Insert a sample in order; it replaces one of equal time."""
        if self.static:
            self.samples[:] = [sample]
            return
        at = _place(self.samples, sample[0])
        if at < len(self.samples) and self.samples[at][0] == sample[0]:
            self.samples[at] = sample
        else:
            self.samples.insert(at, sample)
        oldest = self.samples[-1][0] - _KEPT_NS
        if self.samples[0][0] < oldest:
            del self.samples[: _place(self.samples, oldest)]

    def parent(self, stamp_ns):
        """Parent frame at a time."""
        if self.static or stamp_ns is None:
            return self.samples[-1][1]
        return self.samples[min(_place(self.samples, stamp_ns), len(self.samples) - 1)][1]

    def at(self, frame, stamp_ns):
        """Return (translation, rotation) at a time, interpolated between two samples."""
        if self.static or stamp_ns is None:
            return self.samples[-1][2:]
        after = _place(self.samples, stamp_ns)
        if after < len(self.samples) and self.samples[after][0] == stamp_ns:
            return self.samples[after][2:]
        if after == len(self.samples):
            late = (stamp_ns - self.samples[-1][0]) / 1e9
            raise NoTransform(f"the newest transform of {frame} is {late:.3f} s older than the time that is asked for")
        if after == 0:
            early = (self.samples[0][0] - stamp_ns) / 1e9
            raise NoTransform(f"the oldest transform of {frame} is {early:.3f} s newer than the time that is asked for")
        one, two = self.samples[after - 1], self.samples[after]
        if one[1] != two[1]:
            return two[2:]
        share = (stamp_ns - one[0]) / (two[0] - one[0])
        moved = tuple(a + (b - a) * share for a, b in zip(one[2], two[2]))
        return moved, _between(one[3], two[3], share)


def _place(samples, stamp_ns):
    return bisect.bisect_left(samples, (stamp_ns,))


def _frame(name):
    return name.lstrip("/")


def _then(step, translation, rotation):
    moved, turn = step
    return tuple(a + b for a, b in zip(_turned(turn, translation), moved)), _product(turn, rotation)


def _product(a, b):
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def _conjugate(rotation):
    x, y, z, w = rotation
    return -x, -y, -z, w


def _turned(rotation, point):
    x, y, z = (float(each) for each in point)
    return _product(_product(rotation, (x, y, z, 0.0)), _conjugate(rotation))[:3]


def _between(one, two, share):
    """Interpolate between two rotations, by the shorter path, at constant speed."""
    dot = sum(a * b for a, b in zip(one, two))
    if dot < 0:
        two, dot = tuple(-each for each in two), -dot
    if dot > 0.9995:
        mixed = tuple(a + (b - a) * share for a, b in zip(one, two))
    else:
        angle = math.acos(dot)
        first, second = math.sin((1 - share) * angle) / math.sin(angle), math.sin(share * angle) / math.sin(angle)
        mixed = tuple(a * first + b * second for a, b in zip(one, two))
    length = math.sqrt(sum(each * each for each in mixed))
    return tuple(each / length for each in mixed)
