"""Limit of the requests in flight to one service.

A server of ROS 2 queues ten requests. If more arrive before it has taken these, it loses the oldest
without an error. If many branches call at once, some of their requests wait here.
"""

import collections
import threading
import time

#: Maximum number of requests in flight.
_AT_ONCE = 8
#: A server without a response after this time (s) has received the request and works on it.
_TAKEN_S = 1.0


class Gate:
    """Admits requests in order, up to a limit in flight."""

    def __init__(self):
        self._lock = threading.Lock()
        self._waiting = collections.deque()
        self._passed = {}

    def submit(self, start):
        """Call ``start()`` now or later, on any thread; return a key for :meth:`answered`."""
        key = object()
        with self._lock:
            self._waiting.append((key, start))
        self.pump()
        return key

    def answered(self, key):
        """Release the request of a key, which was answered or is no longer needed."""
        with self._lock:
            if self._passed.pop(key, None) is None:
                self._waiting = collections.deque(each for each in self._waiting if each[0] is not key)
        self.pump()

    def pump(self):
        """Admit waiting requests up to the limit."""
        while True:
            with self._lock:
                now_s = time.monotonic()
                if len(self._passed) >= _AT_ONCE:
                    self._passed = {key: sent_s for key, sent_s in self._passed.items() if now_s - sent_s < _TAKEN_S}
                if not self._waiting or len(self._passed) >= _AT_ONCE:
                    return
                key, start = self._waiting.popleft()
                self._passed[key] = now_s
            start()
