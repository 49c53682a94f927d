"""Threads for callbacks of users, so that the back end waits for none of them."""

import collections
import threading

from rafcon.utils.log import get_logger

logger = get_logger("ros")


class Worker:
    """Calls a function with each item of a queue, on a thread of its own, until ``close``."""

    def __init__(self, name, function, waiting_max):
        self._name = name
        self._function = function
        self._items = collections.deque()
        self._waiting_max = waiting_max
        self._changed = threading.Condition()
        self._closed = False
        self._thread = None

    def put(self, item):
        """Queue an item; if the queue is full, drop the oldest one."""
        with self._changed:
            if self._closed:
                return
            if len(self._items) >= self._waiting_max:
                self._items.popleft()
                logger.warning("%s: the callback is too slow, a message was dropped", self._name)
            self._items.append(item)
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, name=self._name, daemon=True)
                self._thread.start()
            self._changed.notify()

    def close(self):
        """Stop: clear the queue, and begin no other call."""
        with self._changed:
            self._closed = True
            self._items.clear()
            self._changed.notify()

    def _work(self):
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._items or self._closed)
                if self._closed:
                    return
                item = self._items.popleft()
            try:
                self._function(item)
            except Exception:
                logger.exception("%s: the callback failed", self._name)
