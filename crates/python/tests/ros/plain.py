"""Messages as values of JSON, alike on both sides of a test; used by programs with and without ``rclpy``."""

import array
import hashlib

#: Longer arrays of bytes are compared by their length and digest.
WHOLE_MAX = 4096


def data(size):
    """So many bytes, none like the one a block before."""
    block = b"".join(hashlib.sha256(number.to_bytes(4, "little")).digest() for number in range(min(size, 1 << 16) // 32 + 1))
    return (block * (size // len(block) + 1))[:size]


def given(value):
    """A value as it came from JSON, with ``{"bytes": size}`` for long data."""
    if isinstance(value, dict):
        return data(value["bytes"]) if value.keys() == {"bytes"} else {name: given(each) for name, each in value.items()}
    return [given(each) for each in value] if isinstance(value, list) else value


def plain(value):
    """A message of ``rafcon.ros``, or a part of one, as a value of JSON."""
    if isinstance(value, (bytes, bytearray, memoryview)):
        return list(value) if len(value) <= WHOLE_MAX else f"{len(value)} bytes, {hashlib.md5(value).hexdigest()}"
    if isinstance(value, array.array) and value.typecode == "B":
        return plain(value.tobytes())
    if isinstance(value, (list, tuple, array.array)):
        return [plain(each) for each in value]
    if hasattr(value, "items"):
        return {name: plain(each) for name, each in value.items()}
    return value


def of_rclpy(message):
    """A message of ``rclpy``, or a part of one, as a value of JSON."""
    if hasattr(message, "get_fields_and_field_types"):
        return {name: of_rclpy(getattr(message, name)) for name in message.get_fields_and_field_types()}
    if isinstance(message, bytes) and len(message) == 1:
        return message[0]
    if isinstance(message, (list, tuple)):
        return [of_rclpy(each) for each in message]
    if hasattr(message, "tolist") and not isinstance(message, array.array):
        return message.tolist()
    return plain(message)


def filled(message, values):
    """Sets the fields of a message of ``rclpy``."""
    for name, value in values.items():
        setattr(message, name, _fit(message.get_fields_and_field_types()[name], getattr(message, name), value))
    return message


def _fit(kind, now, value):
    if isinstance(value, dict):
        return filled(now, value)
    base = kind.removeprefix("sequence<").rstrip(">").split("[")[0].split(",")[0].strip()
    if base in ("octet", "byte"):
        return [bytes([each]) for each in value] if isinstance(value, (list, bytes)) else bytes([value])
    if isinstance(value, list) and any(isinstance(each, dict) for each in value):
        package, name = base.split("/")
        cls = getattr(__import__(package + ".msg", fromlist=["msg"]), name)
        return [filled(cls(), each) for each in value]
    if isinstance(value, bytes):
        return array.array("B", value)
    return value
