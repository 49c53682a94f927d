"""Random Python values by their number, their encodings read back, and whether two values are the same. Scripts of tests import it, too."""

import math
import random

_TEXTS = ("", "a", "1", "-7", "__int__", "__tuple__", "ключ", "a\nb", '"', "\ud800", "x" * 300, "y" * 2000)
_FLOATS = (0.0, -0.0, 1.0, -2.5, 1e22, 5e-324, math.nan, math.inf, -math.inf, 2.0**53)
_INTS = (0, 1, -1, 2**31, 2**53 - 1, 2**53, -(2**53) - 1, 2**63 - 1, -(2**63), 2**64, 10**30, -(10**900), 2**5000)


def value(number):
    """The value with a number: the same in every process and version of Python."""
    dice = random.Random(number)
    return _any(lambda count: int(dice.random() * count), 3)


def _any(roll, depth):
    leaf = roll(6 if depth == 0 else 10)
    if leaf == 0:
        return (None, True, False, b"bytes", bytes(range(256)), bytearray(b"x"))[roll(6)]
    if leaf in (1, 2):
        return _INTS[roll(len(_INTS))] + roll(3) if roll(2) else roll(2000) - 1000
    if leaf == 3:
        return _FLOATS[roll(len(_FLOATS))] if roll(2) else (roll(10**9) - 5 * 10**8) / 1024
    if leaf in (4, 5):
        return _TEXTS[roll(len(_TEXTS))]
    count = roll(4) if roll(40) else 300
    if leaf == 6:
        return [_any(roll, depth - 1) for _ in range(count)]
    if leaf == 7:
        return tuple(_any(roll, depth - 1) for _ in range(count))
    if leaf == 8:
        return {_key(roll): _any(roll, depth - 1) for _ in range(count)}
    return {roll(100) for _ in range(count)} if roll(2) else frozenset({str(roll(9))})


def _key(roll):
    kind = roll(7)
    if kind < 2:
        return "key %d" % roll(1000)
    return (str(roll(9)), roll(9), roll(9) / 2, (roll(3), "t"), None, 2**53 + roll(5), _TEXTS[roll(9)])[roll(7)]


class Shortened(Exception):
    """The encoding says that it is not all of the value."""


def read_back(shown):
    """The value of an encoding (docs/protocol.md, values)."""
    if isinstance(shown, list):
        return [read_back(item) for item in shown]
    if not isinstance(shown, dict):
        return shown
    if len(shown) == 1:
        ((tag, inner),) = shown.items()
        if tag in ("__int__", "__float__"):
            return {"__int__": int, "__float__": float}[tag](inner)
        if tag == "__tuple__":
            return tuple(map(read_back, inner))
        if tag == "__dict__":
            return {read_back(key): read_back(item) for key, item in inner}
    if "__repr__" in shown:
        return _read_repr(shown)
    return {key: read_back(item) for key, item in shown.items()}


def _read_repr(shown):
    text, kind = shown["__repr__"], shown["__class__"]
    if "__len__" in shown or text.startswith(("a nested ", "an int of ")):
        raise Shortened
    return float(text) if kind == "float" else eval(text)


def is_same(left, right):
    """Equal in type and value, at every depth; NaN is NaN, and -0.0 is not 0.0."""
    if type(left) is not type(right):
        return False
    if isinstance(left, float):
        return repr(left) == repr(right)
    if isinstance(left, (list, tuple)):
        return len(left) == len(right) and all(map(is_same, left, right))
    if isinstance(left, dict):
        keys = {(type(key), key): item for key, item in right.items()}
        found = ((keys.get((type(key), key), keys), item) for key, item in left.items())
        return len(left) == len(right) and all(is_same(one, other) for one, other in found)
    return left == right


def fails(shown, expected):
    """Whether an encoding reads back as another value."""
    try:
        return not is_same(read_back(shown), expected)
    except Shortened:
        return False
