"""ROS 2 in scripts: topics, services, actions, parameters, transforms and time.

    from rafcon import ros

    def execute(self, inputs, outputs, gvm):
        ros.publish("/cmd_vel", {"linear": {"x": 0.1}}, "geometry_msgs/Twist")
        scan = ros.wait_for("/scan", timeout=5)
        ended = ros.action("/navigate_to_pose", {"pose": {"header": {"frame_id": "map"}}})
        return "success" if ended.outcome == "succeeded" else "aborted"

Messages are mappings, or :class:`Message` with fields as attributes. Types are given by name
(``geometry_msgs/Twist``), or taken from other users of the topic, service or action. With
``rclpy``, its classes and objects are accepted as well.

All states of a run share one node, which is created on first use of this package and ends with the
run. Its back end is ``rclpy`` if the interpreter has it, else the program ``rafcon-ros``, which
needs no installation of ROS. ``RAFCON_ROS_BACKEND`` forces ``rclpy`` or ``native``.

Every wait has a timeout (s), and ends when the state of the script is preempted. Then
:class:`~rafcon.core.custom_exceptions.StatePreempted` is raised, once in a run of a state, so that
``finally`` can still stop a robot. Errors of this package are subclasses of :class:`RosError`.
"""

from rafcon.ros._action_server import ActionServer, GoalAborted, ReceivedGoal, action_server
from rafcon.ros._actions import ActionResult, action
from rafcon.ros._backend import BackendLost, Qos, RosError, UnknownType
from rafcon.ros._clock import now, stamp
from rafcon.ros._message import Message
from rafcon.ros._node import close, configure
from rafcon.ros._parameters import ParameterError, param_get, param_set
from rafcon.ros._services import NoServer, Server, call, serve
from rafcon.ros._topics import Subscription, latest, publish, subscribe, wait_for
from rafcon.ros._transforms import Transform, transform
from rafcon.ros._values import MessageError
from rafcon.ros._waits import TimedOut

__all__ = [
    "ActionResult",
    "ActionServer",
    "BackendLost",
    "GoalAborted",
    "Message",
    "MessageError",
    "NoServer",
    "ParameterError",
    "Qos",
    "ReceivedGoal",
    "RosError",
    "Server",
    "Subscription",
    "TimedOut",
    "Transform",
    "UnknownType",
    "action",
    "action_server",
    "call",
    "close",
    "configure",
    "latest",
    "now",
    "param_get",
    "param_set",
    "publish",
    "serve",
    "stamp",
    "subscribe",
    "transform",
    "wait_for",
]
