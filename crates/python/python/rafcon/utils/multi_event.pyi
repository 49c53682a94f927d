from collections.abc import Iterable
from threading import Event

def create(events: Iterable[Event]) -> Event: ...
