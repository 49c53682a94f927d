"""One event that is set as long as one of several is."""

import threading


def create(*events):
    """A ``threading.Event`` that follows others: set if one of them is. They are given one by one, or as an iterable."""
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
