from collections.abc import Callable
from typing import Any

class OwnValues(dict[int, Any]):
    def __init__(self, read: Callable[[], dict[int, Any]], set_one: Callable[[int, Any], None]) -> None: ...
