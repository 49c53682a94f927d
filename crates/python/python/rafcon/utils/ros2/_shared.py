"""What handles need: the node that all states share, and what was made in earlier runs, with a lock for its users."""

import threading

_making = threading.Lock()


def available(node):
    """The node, if there is one; ``RuntimeError`` if not."""
    if node is None:
        raise RuntimeError(
            "there is no ROS 2 node in the global variable `rafcon_ros_node`; a state that makes it "
            "(init_ros2_node) must run first"
        )
    return node


def shared(gvm, variable, name, make):
    """(object, lock) kept under a name in the dictionary of a global variable; ``make()`` makes a missing object."""
    with _making:
        kept = gvm.get_variable(variable)
        if kept is None:
            kept = {}
            gvm.set_variable(variable, kept, per_reference=True)
        if name not in kept:
            kept[name] = (make(), threading.Lock())
        return kept[name]


def forget(gvm, variable, name):
    """Takes an object out of the dictionary."""
    with _making:
        (gvm.get_variable(variable) or {}).pop(name, None)
