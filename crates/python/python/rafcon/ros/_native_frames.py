"""Frames between this process and its helper: a JSON object, followed by the bytes of arrays.

``docs/ros.md`` describes them.
"""

import array
import json
import struct

_HEAD = struct.Struct("<II")
#: Maximum size of a frame, in bytes.
_FRAME_MAX = 1 << 30
#: Array codes whose sizes differ between computers, by kind and bytes of a value.
_CODES = {
    **{("u", 1): "B", ("u", 2): "H", ("u", 4): "I", ("u", 8): "Q"},
    **{("i", 1): "b", ("i", 2): "h", ("i", 4): "i", ("i", 8): "q"},
    **{("f", 4): "f", ("f", 8): "d"},
}


def nul_in(value, place=""):
    """Path of a text with a NUL character, such as ``.names[2]``, or None."""
    if isinstance(value, str):
        return place if "\0" in value else None
    if isinstance(value, dict):
        parts = ((f"{place}.{name}", each) for name, each in value.items())
    elif isinstance(value, list):
        parts = ((f"{place}[{at}]", each) for at, each in enumerate(value))
    else:
        return None
    return next((found for part, each in parts for found in (nul_in(each, part),) if found is not None), None)


def packed(fields):
    """Encode a dict as a frame; arrays follow the text."""
    chunks = []
    size = 0

    def behind(value):
        nonlocal size
        view = memoryview(value)
        kind = "f" if view.format in "fd" else "u" if view.format.isupper() else "i"
        code = _CODES[kind, view.itemsize]
        content = view.cast("B")
        start, size = size, size + content.nbytes
        chunks.append(content)
        return {"$": [code, start, content.nbytes]}

    text = json.dumps(fields, default=behind, separators=(",", ":")).encode("ascii")
    if len(text) + size > _FRAME_MAX:
        raise ValueError(f"a message of {len(text) + size} bytes is larger than {_FRAME_MAX}")
    return b"".join((_HEAD.pack(len(text) + size, len(text)), text, *chunks))


def read(stream):
    """Read the next dict from a stream, or None at its end, and the number of its bytes."""
    head = stream.read(_HEAD.size)
    if len(head) < _HEAD.size:
        return None, 0
    total, length = _HEAD.unpack(head)
    content = stream.read(total)
    if len(content) < total:
        return None, 0
    return unpacked(content[:length], memoryview(content)[length:]), total


def unpacked(text, behind):
    """Decode the dict of a text, with the arrays that follow it."""

    def made(entries):
        place = entries.get("$")
        if place is None:
            return entries
        code, start, size = place
        content = behind[start : start + size]
        if code == "B":
            return bytes(content)
        values = array.array(code)
        values.frombytes(content)
        return values

    if b'{"$":' in text:
        return json.loads(text, object_hook=made)
    return json.loads(text)
