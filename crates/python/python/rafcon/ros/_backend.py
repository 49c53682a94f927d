"""Interface of the back ends of ``rafcon.ros``, and the form of messages at this interface.

Names
    Every name of a topic, service, action or node is absolute (``/robot/scan``), and every type has
    its full name: ``geometry_msgs/msg/Twist``, ``std_srvs/srv/Trigger``,
    ``nav2_msgs/action/NavigateToPose``.

Messages
    A message is a plain ``dict`` from the name of each field to its value, and holds all fields in the order of the
    type. Values are

    ============================================ =============================================================
    type of the field                            value
    ============================================ =============================================================
    ``bool``                                     ``bool``
    ``byte``, ``char``, ``int8`` … ``uint64``    ``int``
    ``float32``, ``float64``                     ``float`` (NaN and infinities included)
    ``string``, ``wstring``                      ``str``
    a message                                    ``dict``
    array of ``byte``, ``char``, ``uint8``       ``bytes``
    array of another integer, or of floats       ``array.array`` of the type code in :data:`TYPE_CODES`
    array of ``bool``, ``string``, of a message  ``list`` of the values above
    ============================================ =============================================================

    Fixed, bounded and unbounded arrays have one form. A message without fields is ``{}``. Messages
    *to* a back end are complete and checked against the type. Messages *from* it must be complete.

Threads
    Every method may be called on any thread, and on several at once; none waits for a peer.
    Callbacks run on a thread of the back end, one after the other in the order of their events.
    They return at once, do not raise, and may call any method of the back end. After ``close()`` of
    an object none of its callbacks *begins*.

Failure
    A method whose back end is lost raises :class:`BackendLost`. Each pending operation ends by its
    own callback (``done(None, why)``, ``failed(why)``). Then ``lost(why)`` of :class:`Listener` is
    called, once.
"""

from __future__ import annotations

import math
from typing import AbstractSet, Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Protocol, Tuple

#: Type codes of ``array.array`` for the arrays that have them.
TYPE_CODES = {
    "int8": "b",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}

#: Types whose arrays are ``bytes``.
BYTES = ("byte", "char", "uint8")

#: All field types except messages.
PRIMITIVES = ("bool", "string", "wstring", *BYTES, *TYPE_CODES)

#: States of a goal, as in ``action_msgs/msg/GoalStatus``.
ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = 1, 2, 3, 4, 5, 6


class RosError(Exception):
    """A ROS operation failed; the message gives cause, place and remedy."""


class UnknownType(RosError):
    """No interface of this name is known; the message lists the places searched."""


class BackendLost(RosError):
    """The back end has ended, or was closed."""


class Field(NamedTuple):
    """Field of a message type."""

    name: str
    #: One of :data:`PRIMITIVES`, or the full name of a message type.
    type: str
    #: ``one``, or for arrays ``fixed`` (exactly ``size``), ``bounded`` (up to ``size``) or ``unbounded``.
    kind: str = "one"
    #: Size of a fixed or bounded array; otherwise 0.
    size: int = 0
    #: Maximum length of a ``string`` or ``wstring``, or 0.
    text_max: int = 0
    #: The default in the form of messages, or None without a default (then zero, empty, false).
    default: Any = None


class MessageType(NamedTuple):
    """Message type; also a request of a service, a goal of an action and so on."""

    #: ``geometry_msgs/msg/Twist``, ``std_srvs/srv/Trigger_Request``, ``nav2_msgs/action/NavigateToPose_Goal``.
    name: str
    fields: Tuple[Field, ...]
    #: Constants by name.
    constants: Mapping[str, Any] = {}


class Qos(NamedTuple):
    """Quality of service of a publisher or subscription."""

    #: ``reliable`` or ``best_effort``.
    reliability: str = "reliable"
    #: ``volatile`` or ``transient_local`` (*latched*).
    durability: str = "volatile"
    #: Number of messages kept; 0: all.
    depth: int = 10


class Endpoint(NamedTuple):
    """Publisher or subscription of a topic, also of the back end itself."""

    #: The absolute name of its node; empty if it is unknown yet.
    node: str
    type_name: str
    #: ``reliable`` or ``best_effort``, ``volatile`` or ``transient_local``; ``depth`` is meaningless here.
    qos: Qos


class Settings(NamedTuple):
    """Settings of the node."""

    #: The node's name, ``rafcon_…``, and its namespace, which begins with ``/``.
    name: str
    namespace: str = "/"
    #: Domain; None: the default of ROS (``ROS_DOMAIN_ID``).
    domain: Optional[int] = None
    #: Folders with interface files, searched first: ``FOLDER/PACKAGE/{msg,srv,action}/NAME.{msg,srv,action}``.
    type_folders: Tuple[str, ...] = ()


class Listener(Protocol):
    """Receiver of events of the whole back end."""

    def lost(self, why: str) -> None:
        """The back end has ended without a request."""

    def changed(self) -> None:
        """Nodes, endpoints, services or actions may have changed. Not all back ends call this."""

    def say(self, level: str, text: str) -> None:
        """Log a line with a level: ``debug``, ``info``, ``warning`` or ``error``."""


class Closable(Protocol):
    """Resource that can be released."""

    def close(self) -> None:
        """Release it; a second call does nothing."""


class Publisher(Closable, Protocol):
    """Publisher on one topic."""

    def publish(self, message: Dict[str, Any]) -> None:
        """Send a message; it leaves this process (or the back end's) before any later ``close``."""

    def subscribers(self) -> int:
        """Number of matched subscriptions."""


class Subscription(Closable, Protocol):
    """Subscription of one topic."""

    def publishers(self) -> int:
        """Number of matched publishers."""


class Client(Closable, Protocol):
    """Client of one service."""

    def servers(self, sent_s: float = math.inf) -> AbstractSet[Optional[bytes]]:
        """Processes of the servers that a request would reach now; None for unknown processes.

        With ``sent_s`` (by ``time.monotonic``), excludes servers that started later in the place of
        a dead one. A server that ends properly disappears at once. One that is killed during a call
        disappears within 1.5 s, long before the lease of its participant expires (20 s by default).
        So does one whose reliable reader acknowledges nothing. A live but busy server stays.
        """

    def send(self, request: Dict[str, Any], done: Callable[[Optional[Dict[str, Any]], Optional[str]], None]) -> Closable:
        """Send a request. Unless closed before, ``done`` is called once.

        Its arguments are ``(response, None)``, or ``(None, why)`` after a failure.
        """


class GoalEvents(Protocol):
    """Receiver of events of one goal that was sent."""

    def accepted(self) -> None:
        """The server accepts the goal; the back end has requested the result before this call."""

    def rejected(self) -> None:
        """The server rejects the goal: the last call."""

    def feedback(self, message: Dict[str, Any]) -> None:
        """The server sends feedback."""

    def status(self, status: int) -> None:
        """The server's topic of states has a new state of this goal.

        Final states may arrive before the result, or without it.
        """

    def result(self, status: int, message: Dict[str, Any]) -> None:
        """The goal ended as ``status`` (SUCCEEDED, CANCELED, ABORTED): the last call."""

    def failed(self, why: str) -> None:
        """The goal failed for a reason on this side: the last call."""


class Goal(Closable, Protocol):
    """Goal that was sent. ``close`` ends its events, without cancelling it."""

    #: 16 bytes.
    goal_id: bytes

    def cancel(self, done: Callable[[Optional[int], Optional[str]], None]) -> None:
        """Request cancellation from the server, also before it has accepted the goal.

        ``done(code, None)`` receives the ``return_code`` of the response (0: cancels, 1: refused,
        2: unknown goal, 3: ended), ``done(None, why)`` a failure. It also works after ``close``.
        """


class ActionClient(Closable, Protocol):
    """Client of one action. ``close`` fails active goals without cancelling them."""

    def servers(self, sent_s: float = math.inf) -> AbstractSet[Optional[bytes]]:
        """Processes of servers whose services and topics are all matched; see :class:`Client`."""

    def send(self, goal: Dict[str, Any], events: GoalEvents) -> Goal:
        """Send a goal with a new id."""


class ServiceRequest(Protocol):
    """Received request."""

    request: Dict[str, Any]

    def answer(self, response: Dict[str, Any]) -> None:
        """Send the response, on any thread, once; without it, the caller waits in vain."""


class ServerGoal(Protocol):
    """Received goal. Call either ``accept`` or ``reject``, soon, on any thread."""

    goal_id: bytes
    goal: Dict[str, Any]

    def accept(self, cancel: Callable[[], bool]) -> None:
        """Accept the goal; it executes from now on.

        ``cancel()`` is called when a client requests cancellation. If it returns True, the state
        becomes CANCELING.
        """

    def reject(self) -> None:
        """Reject the goal."""

    def feedback(self, message: Dict[str, Any]) -> None:
        """Send feedback to the clients."""

    def finish(self, status: int, result: Dict[str, Any]) -> None:
        """End the goal as SUCCEEDED, CANCELED (only while CANCELING) or ABORTED.

        The result is kept for a while.
        """


class Backend(Protocol):
    """Back end with one node. Its factory has no arguments, and has no effect before ``start``."""

    #: ``rclpy`` or ``native``.
    name: str

    def start(self, settings: Settings, listener: Listener) -> None:
        """Create the node; :class:`RosError` on failure. May wait for a helper process."""

    def close(self) -> None:
        """Close the node with all its objects; return when none of them is running (within 2 s)."""

    def describe(self, type_name: str) -> Mapping[str, MessageType]:
        """Type with all types that it contains, by name; :class:`UnknownType` if it is unknown.

        For ``std_srvs/srv/Trigger``: ``…Trigger_Request`` and ``…Trigger_Response``. For
        ``p/action/A``: ``p/action/A_Goal``, ``p/action/A_Result`` and ``p/action/A_Feedback``.
        Includes the messages in their fields.
        """

    def publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        """Create a publisher."""

    def subscription(self, topic: str, type_name: str, qos: Qos, heard: Callable[[Dict[str, Any]], None]) -> Subscription:
        """Subscribe to a topic; the callback is called with each message."""

    def client(self, service: str, type_name: str) -> Client:
        """Create a client of a service."""

    def service(self, name: str, type_name: str, asked: Callable[[ServiceRequest], None]) -> Closable:
        """Offer a service: ``asked(request)`` is called for each request."""

    def action_client(self, action: str, type_name: str) -> ActionClient:
        """Create a client of an action."""

    def action_server(self, name: str, type_name: str, asked: Callable[[ServerGoal], None]) -> Closable:
        """Offer an action: ``asked(goal)`` is called for each goal.

        ``close`` aborts executing goals, with an empty result.
        """

    def publishers_of(self, topic: str) -> List[Endpoint]:
        """Known publishers on a topic, of any type."""

    def subscriptions_of(self, topic: str) -> List[Endpoint]:
        """Known subscriptions of a topic, of any type."""

    def topics(self) -> Mapping[str, Tuple[str, ...]]:
        """All known topics, with the names of their types."""

    def services(self) -> Mapping[str, Tuple[str, ...]]:
        """All known services, with the names of their types.

        Includes services of actions (``…/_action/send_goal``).
        """

    def nodes(self) -> List[str]:
        """Absolute names of all known nodes, including this one."""
