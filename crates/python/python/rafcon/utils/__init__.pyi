from typing import Any

class classproperty(property):
    def __get__(self, instance: Any, owner: type | None = None) -> Any: ...
