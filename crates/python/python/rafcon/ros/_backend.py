"""What lies between ``rafcon.ros`` and ROS 2: the interface of a back end, and the one form in which messages cross it.

Names
    Every name of a topic, service, action or node is absolute when it gets here (``/robot/scan``), every type is
    spelled in full: ``geometry_msgs/msg/Twist``, ``std_srvs/srv/Trigger``, ``nav2_msgs/action/NavigateToPose``.

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

    Whether an array is fixed, bounded or unbounded makes no difference. A message without fields is ``{}``.
    What goes *to* a back end is complete and checked against the type; what comes *from* one must be complete as well.

Threads
    Every method may be called on any thread, and on several at once; none waits for a peer. Callbacks come on a thread
    of the back end, one after the other in the order in which things happened; they return at once, do not raise, and
    may call any method of the back end. After ``close()`` of an object no callback of it *begins*.

Failure
    A method whose back end is lost raises :class:`BackendLost`. What is under way then ends by its own callback
    (``done(None, why)``, ``failed(why)``), then ``lost(why)`` of :class:`Listener` is called, once.
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
    """Something about ROS failed; the text says what, where, and the way out."""


class UnknownType(RosError):
    """No interface of this name is known; the text says where was looked."""


class BackendLost(RosError):
    """The back end has ended, or was closed."""


class Field(NamedTuple):
    """A field of a message type."""

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
    """A message type; also the request of a service, the goal of an action and so on."""

    #: ``geometry_msgs/msg/Twist``, ``std_srvs/srv/Trigger_Request``, ``nav2_msgs/action/NavigateToPose_Goal``.
    name: str
    fields: Tuple[Field, ...]
    #: Constants by name.
    constants: Mapping[str, Any] = {}


class Qos(NamedTuple):
    """The quality of service of a publisher or subscription."""

    #: ``reliable`` or ``best_effort``.
    reliability: str = "reliable"
    #: ``volatile`` or ``transient_local`` (*latched*).
    durability: str = "volatile"
    #: Number of messages kept; 0: all.
    depth: int = 10


class Endpoint(NamedTuple):
    """A publisher or subscription that somebody has on a topic, the back end's own included."""

    #: The absolute name of its node; empty if it is unknown yet.
    node: str
    type_name: str
    #: ``reliable`` or ``best_effort``, ``volatile`` or ``transient_local``; ``depth`` is meaningless here.
    qos: Qos


class Settings(NamedTuple):
    """How the node is to be."""

    #: The node's name, ``rafcon_…``, and its namespace, which begins with ``/``.
    name: str
    namespace: str = "/"
    #: Domain; None: the default of ROS (``ROS_DOMAIN_ID``).
    domain: Optional[int] = None
    #: Folders with interface files, searched first: ``FOLDER/PACKAGE/{msg,srv,action}/NAME.{msg,srv,action}``.
    type_folders: Tuple[str, ...] = ()


class Listener(Protocol):
    """What hears about the back end as a whole."""

    def lost(self, why: str) -> None:
        """It has ended without being asked to."""

    def changed(self) -> None:
        """Nodes, endpoints, services or actions may have come or gone. A back end that cannot tell never calls this."""

    def say(self, level: str, text: str) -> None:
        """A line for the log: ``debug``, ``info``, ``warning`` or ``error``."""


class Closable(Protocol):
    """Something that can be given back."""

    def close(self) -> None:
        """Gives it back; a second call does nothing."""


class Publisher(Closable, Protocol):
    """Publishes on one topic."""

    def publish(self, message: Dict[str, Any]) -> None:
        """Sends a message; it has left this process (or the back end's) before ``close`` of anything takes effect."""

    def subscribers(self) -> int:
        """How many subscriptions are matched with it now."""


class Subscription(Closable, Protocol):
    """Hears one topic."""

    def publishers(self) -> int:
        """How many publishers are matched with it now."""


class Client(Closable, Protocol):
    """Calls one service."""

    def servers(self, sent_s: float = math.inf) -> AbstractSet[Optional[bytes]]:
        """The processes of the servers that a request would reach now; None for those that are not told apart.

        With a time of ``time.monotonic`` without those that were started since in the place of one that died.
        A server that ends properly is gone at once, one that is killed within 1.5 s while a call waits (the lease of
        its participant, 20 s by default, is too long: a reliable reader that acknowledges nothing is gone, too).
        One that lives and is busy stays.
        """

    def send(self, request: Dict[str, Any], done: Callable[[Optional[Dict[str, Any]], Optional[str]], None]) -> Closable:
        """Sends a request. ``done(response, None)`` or ``done(None, why)`` is called once, unless closed before."""


class GoalEvents(Protocol):
    """What hears about one goal that was sent."""

    def accepted(self) -> None:
        """The server takes the goal; the back end has asked for the result before this is called."""

    def rejected(self) -> None:
        """The server does not take it: the last call."""

    def feedback(self, message: Dict[str, Any]) -> None:
        """The server tells about it."""

    def status(self, status: int) -> None:
        """The server's topic of states has a new state of this goal. Final ones may come before the result, or alone."""

    def result(self, status: int, message: Dict[str, Any]) -> None:
        """It ended as ``status`` (SUCCEEDED, CANCELED, ABORTED): the last call."""

    def failed(self, why: str) -> None:
        """Nothing more will be heard of it, for a reason on this side: the last call."""


class Goal(Closable, Protocol):
    """A goal that was sent. ``close`` lets go of it without cancelling: its events end."""

    #: 16 bytes.
    goal_id: bytes

    def cancel(self, done: Callable[[Optional[int], Optional[str]], None]) -> None:
        """Asks the server to cancel, also before it has accepted the goal.

        ``done(code, None)`` has the answer's ``return_code`` (0: it cancels, 1: refused, 2: unknown goal, 3: ended),
        ``done(None, why)`` says that none will come. It also works after ``close``.
        """


class ActionClient(Closable, Protocol):
    """Sends goals to one action. Its ``close`` does not cancel goals; it fails those that are under way."""

    def servers(self, sent_s: float = math.inf) -> AbstractSet[Optional[bytes]]:
        """The processes of the servers whose services and topics are all matched now; else as in :class:`Client`."""

    def send(self, goal: Dict[str, Any], events: GoalEvents) -> Goal:
        """Sends a goal under a new id."""


class ServiceRequest(Protocol):
    """A request that came in."""

    request: Dict[str, Any]

    def answer(self, response: Dict[str, Any]) -> None:
        """Answers it, on any thread, once; without an answer its caller waits in vain."""


class ServerGoal(Protocol):
    """A goal that came in. Exactly one of ``accept`` and ``reject`` is called, soon, on any thread."""

    goal_id: bytes
    goal: Dict[str, Any]

    def accept(self, cancel: Callable[[], bool]) -> None:
        """Takes it; it executes from now on. ``cancel()`` is called when a client wants it cancelled, and says
        whether that will be done; then the state is CANCELING."""

    def reject(self) -> None:
        """Does not take it."""

    def feedback(self, message: Dict[str, Any]) -> None:
        """Tells the clients."""

    def finish(self, status: int, result: Dict[str, Any]) -> None:
        """It ended as SUCCEEDED, CANCELED (only while CANCELING) or ABORTED. The result is kept for a while."""


class Backend(Protocol):
    """One node. A class or function that makes it takes nothing; nothing happens before ``start``."""

    #: ``rclpy`` or ``native``.
    name: str

    def start(self, settings: Settings, listener: Listener) -> None:
        """Makes the node; raises :class:`RosError` if that is impossible. It may wait for this process's own helper."""

    def close(self) -> None:
        """Ends it, with everything that was made by it; returns when nothing of it is left running (within 2 s)."""

    def describe(self, type_name: str) -> Mapping[str, MessageType]:
        """The type and all that it is made of, by name; raises :class:`UnknownType`.

        Of ``std_srvs/srv/Trigger``: ``…Trigger_Request``, ``…Trigger_Response``; of ``p/action/A``: ``p/action/A_Goal``,
        ``p/action/A_Result``, ``p/action/A_Feedback``; and the messages in their fields.
        """

    def publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        """Makes a publisher."""

    def subscription(self, topic: str, type_name: str, qos: Qos, heard: Callable[[Dict[str, Any]], None]) -> Subscription:
        """Hears a topic: ``heard(message)`` for each message."""

    def client(self, service: str, type_name: str) -> Client:
        """Makes a client of a service."""

    def service(self, name: str, type_name: str, asked: Callable[[ServiceRequest], None]) -> Closable:
        """Offers a service: ``asked(request)`` for each request."""

    def action_client(self, action: str, type_name: str) -> ActionClient:
        """Makes a client of an action."""

    def action_server(self, name: str, type_name: str, asked: Callable[[ServerGoal], None]) -> Closable:
        """Offers an action: ``asked(goal)`` for each goal. ``close`` aborts what executes, with an empty result."""

    def publishers_of(self, topic: str) -> List[Endpoint]:
        """The publishers that are known of a topic, whatever their types."""

    def subscriptions_of(self, topic: str) -> List[Endpoint]:
        """The subscriptions that are known of a topic, whatever their types."""

    def topics(self) -> Mapping[str, Tuple[str, ...]]:
        """All topics that are known, with the names of their types."""

    def services(self) -> Mapping[str, Tuple[str, ...]]:
        """All services that are known, with the names of their types; those of actions too (``…/_action/send_goal``)."""

    def nodes(self) -> List[str]:
        """The absolute names of all nodes that are known, this one included."""
