"""Shared objects of handles: the node of all states, and objects of earlier runs with locks."""

import threading

_making = threading.Lock()


def available(node):
    """Return the node; ``RuntimeError`` if there is none."""
    if node is None:
        raise RuntimeError(
            "there is no ROS 2 node in the global variable `rafcon_ros_node`; a state that makes it "
            "(init_ros2_node) must run first"
        )
    return node


def shared(gvm, variable, name, make):
    """Return (object, lock) of a name from the dictionary in a global variable.

    ``make()`` creates a missing object.
    """
    with _making:
        kept = gvm.get_variable(variable)
        if kept is None:
            kept = {}
            gvm.set_variable(variable, kept, per_reference=True)
        if name not in kept:
            kept[name] = (make(), threading.Lock())
        return kept[name]


def forget(gvm, variable, name):
    """Remove an object from the dictionary."""
    with _making:
        (gvm.get_variable(variable) or {}).pop(name, None)
