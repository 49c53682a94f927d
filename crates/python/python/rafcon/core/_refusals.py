"""Errors for calls that the process of a running machine does not support."""

from rafcon import _objects
from rafcon.core.custom_exceptions import MachineChangeNotSupported


def hosted(call):
    """Raise ``MachineChangeNotSupported`` in a process that was started to run one machine."""
    if _objects.is_host():
        raise MachineChangeNotSupported(call)
