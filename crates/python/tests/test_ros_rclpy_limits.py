"""The end of a node of ``rclpy`` whose executor fails, without ``rclpy``: the test says how the executor does."""

import importlib
import os
import sys
import unittest
from unittest import mock

import stage  # noqa: F401, it brings the package
from rafcon.ros import _node
from rafcon.ros._backend import BackendLost, Settings

#: What of ``rclpy`` the back end imports.
MODULES = ("callback_groups", "client", "context", "duration", "executors", "node", "qos", "action", "action.client", "action.server", "task")
OTHERS = ("action_msgs", "action_msgs.msg", "action_msgs.srv", "unique_identifier_msgs", "unique_identifier_msgs.msg")


def backend_module():
    """``rafcon.ros._rclpy``, above modules without content."""
    names = ["rclpy", *(f"rclpy.{name}" for name in MODULES), *OTHERS]
    stubs = {name: mock.MagicMock() for name in names}
    stubs["rclpy.executors"].ExternalShutdownException = type("ExternalShutdownException", (Exception,), {})
    with mock.patch.dict(sys.modules, stubs):
        return importlib.import_module("rafcon.ros._rclpy")


class Executor:
    """Fails where its list says so."""

    def __init__(self, outcomes):
        self.left = list(outcomes)

    def spin_once(self):
        if self.left.pop(0) == "fails":
            raise RuntimeError("it was destroyed")


class Failures(unittest.TestCase):
    def test_an_executor_that_fails_again_and_again_ends_the_node_and_the_next_use_makes_another(self):
        backend = backend_module().RclpyBackend()
        settings = Settings(name="a", namespace="/", domain=None, type_folders=())
        node = _node.Node(backend, settings, False)
        node.pid = os.getpid()
        self.addCleanup(setattr, _node, "_node", None)
        _node._node = backend._listener = node
        backend.executor = Executor(["fails"] * 9 + ["spins"] + ["fails"] * 10)
        backend.check()
        with self.assertLogs("rafcon", "ERROR") as logged:
            backend._spin()
        self.assertEqual(backend.executor.left, [])
        self.assertIn("ROS is gone: RuntimeError: it was destroyed; the next call of rafcon.ros makes a new node", logged.output[0])
        for check in (backend.check, node.check):
            with self.assertRaises(BackendLost):
                check()
        with mock.patch.object(_node, "_made", lambda: mock.Mock(pid=os.getpid())):
            self.assertIsNot(_node.node(), node)


if __name__ == "__main__":
    unittest.main()
