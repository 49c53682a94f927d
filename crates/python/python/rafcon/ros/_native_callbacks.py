"""Queue of events for the callback thread. Independent of the helper and of the receivers."""

import collections
import threading

#: Capacity of the queue of messages and requests; the oldest is dropped for a new one.
_MESSAGES_MAX = 10_000
#: Capacity in bytes of frames, without the newest message.
_BYTES_MAX = 64 << 20
#: Events that are no responses.
_UNASKED = ("heard", "request")


class Callbacks:
    """Queue of events in order, for one consuming thread.

    Messages and requests are limited, because their rate depends on other programs. All other
    events result from calls of scripts, and are never dropped.
    """

    def __init__(self):
        self._numbers = 0
        self._messages = collections.deque()
        self._others = collections.deque()
        self._bytes = 0
        self._dropped = 0
        self._changed = threading.Condition()

    def put(self, event, size=0):
        """Add an event, or None at the end. ``size`` is the number of bytes of its frame."""
        with self._changed:
            if event is not None and any(kind in event for kind in _UNASKED):
                self._bytes += size
                self._add(self._messages, event, size)
                self._make_room()
            else:
                self._add(self._others, event, size)
            self._changed.notify()

    def get(self):
        """Return the oldest event; wait until there is one."""
        with self._changed:
            self._changed.wait_for(lambda: self._messages or self._others)
            line = min((each for each in (self._messages, self._others) if each), key=lambda each: each[0][0])
            _number, event, size = line.popleft()
            if line is self._messages:
                self._bytes -= size
            return event

    def _add(self, line, event, size):
        self._numbers += 1
        line.append((self._numbers, event, size))

    def _make_room(self):
        while len(self._messages) > _MESSAGES_MAX or (self._bytes > _BYTES_MAX and len(self._messages) > 1):
            self._bytes -= self._messages.popleft()[2]
            self._dropped += 1
            # Report the first, second, fourth, eighth …
            if self._dropped & (self._dropped - 1) == 0:
                text = f"the queue of received messages is full: {self._dropped} of the oldest messages are dropped"
                self._add(self._others, {"say": "warning", "text": text}, 0)
