"""Refusal of what the process of a running machine cannot do: it runs that one machine, from beginning to end."""

from rafcon import _objects
from rafcon.core.custom_exceptions import MachineChangeNotSupported


def hosted(call):
    """Raises ``MachineChangeNotSupported`` in a process that was started to run one machine."""
    if _objects.is_host():
        raise MachineChangeNotSupported(call)
