"""How many requests are on their way to one service at a time.

A server of ROS 2 keeps ten requests; of those that come before it has taken them, it loses the oldest without a word. So
of many branches that call at once, some wait here.
"""

import collections
import threading
import time

#: Maximum number of requests in flight.
_AT_ONCE = 8
#: A server without a response after this time (s) has received the request and works on it.
_TAKEN_S = 1.0


class Gate:
    """Lets requests through in their order."""

    def __init__(self):
        self._lock = threading.Lock()
        self._waiting = collections.deque()
        self._passed = {}

    def submit(self, start):
        """Calls ``start()`` now or later, on any thread; returns a key for :meth:`answered`."""
        key = object()
        with self._lock:
            self._waiting.append((key, start))
        self.pump()
        return key

    def answered(self, key):
        """The request of a key has its answer, or is not wanted any more."""
        with self._lock:
            if self._passed.pop(key, None) is None:
                self._waiting = collections.deque(each for each in self._waiting if each[0] is not key)
        self.pump()

    def pump(self):
        """Lets through what may go."""
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
