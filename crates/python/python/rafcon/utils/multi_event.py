"""Combination of several events in one."""

import threading


def create(*events):
    """Create a ``threading.Event`` that is set while at least one of the events is set.

    ``events`` are single arguments or one iterable. Their methods ``set`` and ``clear`` are
    replaced.
    """
    events = list(events[0] if len(events) == 1 and not hasattr(events[0], "is_set") else events)
    combined = threading.Event()
    lock = threading.Lock()

    def update():
        with lock:
            (combined.set if any(event.is_set() for event in events) else combined.clear)()

    for event in events:
        _follow(event, update)
    update()
    return combined


def _follow(event, update):
    def following(method):
        def call():
            method()
            update()

        return call

    event.set = following(event.set)
    event.clear = following(event.clear)
