from typing import Any

class RafconRosNode:
    tf_buffer: Any
    tf_listener: Any
    def __init__(self, node_name: str, namespace: str = "") -> None: ...
    def __getattr__(self, name: str) -> Any: ...
