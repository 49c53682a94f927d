"""Reads what a runner sends after its hello: frames of messages and of events (docs/protocol.md, docs/journal.md)."""

import json
import struct

LEVELS = ("verbose", "debug", "info", "warning", "error")
STREAMS = ("stdout", "stderr", "logger", "engine")


class Items:
    """The items of the journal in some bytes, one after the other."""

    def __init__(self, data):
        self._data = data
        self._at = 0

    def is_at_end(self):
        return self._at == len(self._data)

    def take(self, count):
        self._at += count
        return self._data[self._at - count : self._at]

    def byte(self):
        return self.take(1)[0]

    def number(self):
        value = shift = 0
        while True:
            byte = self.byte()
            value |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80:
                return value

    def signed(self):
        value = self.number()
        return (value >> 1) ^ -(value & 1)

    def bytes(self):
        return self.take(self.number())

    def text(self):
        return self.bytes().decode()

    def list(self, one):
        return [one() for _ in range(self.number())]

    def value(self):
        """A value in an event: itself, or the number of one that was defined, in a tuple."""
        kind = self.byte()
        if kind < 4:
            return (None, None, False, True)[kind]
        if kind == 4:
            return self.signed()
        if kind == 5:
            return struct.unpack("<d", self.take(8))[0]
        return self.text() if kind == 6 else (self.number(),)


class EventStream:
    """Messages as dictionaries; events without their values."""

    def __init__(self, stream):
        self._stream = stream
        self._places = {}
        self._values = {}
        self._waiting = []
        self._last = 0

    def next(self):
        """The next message; none at the end."""
        while not self._waiting:
            head = self._stream.read(5)
            if len(head) < 5:
                return None
            kind, length = struct.unpack("<cI", head)
            content = self._stream.read(length)
            if len(content) < length:
                return None
            if kind == b"m":
                self._waiting.append(json.loads(content))
            elif kind == b"e":
                self._read_blocks(Items(content))
        return self._waiting.pop(0)

    def _read_blocks(self, blocks):
        while not blocks.is_at_end():
            sequence, t_ns, items = blocks.number(), blocks.number(), Items(blocks.bytes())
            while not items.is_at_end():
                tag = items.byte()
                if tag in (8, 9):
                    self._define(tag, items)
                    continue
                t_ns += items.number()
                event = self._event(tag, items)
                if event and sequence > self._last:
                    self._last = sequence
                    self._waiting.append({"message": "event", "sequence": sequence, "t_ns": t_ns, "event": event})
                sequence += 1

    def _define(self, tag, items):
        number = items.number()
        if tag == 8:
            path, _names, _flags = items.text(), items.text(), items.byte()
            for _ in range(3):
                items.list(lambda: (items.number(), items.text()))
            self._places[number] = path, dict(items.list(lambda: (items.signed(), items.text())))
        else:
            self._values[number] = json.loads(items.bytes())
            items.text()
            content = items.byte()
            if content in (1, 2, 3):
                items.bytes()
            if content == 2:
                items.number()

    def _event(self, tag, items):
        if tag == 7:
            return json.loads(items.bytes())
        if tag == 6:
            place, level, stream = items.number(), LEVELS[items.byte()], STREAMS[items.byte()]
            path = self._places[place - 1][0] if place else ""
            return {"type": "log", "path": path, "level": level, "stream": stream, "message": items.text()}
        if tag == 10:
            event = {"type": "went_back", "sequence": items.number()}
            items.bytes()
            return event
        if tag == 4:
            items.text()
            if items.byte():
                items.value()
            return None
        path, outcomes = self._places[items.number()]
        if tag == 1:
            items.list(items.value)
            return self._undone({"type": "entered", "path": path}, items)
        if tag == 2:
            number = items.signed()
            names = {-1: "aborted", -2: "preempted", **outcomes}
            event = {"type": "left", "path": path, "outcome": {"id": number, "name": names.get(number, str(number))}}
            items.list(items.value)
            if items.byte():
                event["error"] = self._short(items.value())
            return self._undone(event, items)
        if tag == 3:
            items.number()
        items.value()
        return None

    def _undone(self, event, items):
        undoes = items.number()
        return {**event, "undoes": undoes} if undoes else event

    def _short(self, value):
        """An error in short: class and text of an exception, or a text."""
        if isinstance(value, tuple):
            value = self._values.get(value[0])
        if isinstance(value, dict) and "__exc__" in value:
            value = {"__exc__": value["__exc__"], "msg": value.get("msg")}
        return value
