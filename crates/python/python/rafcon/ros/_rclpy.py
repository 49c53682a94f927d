"""Back end with ``rclpy``: any middleware, and all interfaces that the interpreter finds."""

import math
import os
import threading
import uuid

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from rafcon.ros._backend import BackendLost, Endpoint, Qos, RosError
from rafcon.ros._delivery import deliver
from rafcon.ros._greeting import is_wanted
from rafcon.ros._liveness import Liveness
from rafcon.ros._rclpy_actions import ActionClient, ActionServer
from rafcon.ros._rclpy_messages import Classes, interface

_ANSWERS_MAX = 1000
#: Topic that each node publishes.
_OF_EACH_NODE = "/parameter_events"
#: Number of consecutive failures that end the executor.
_FAILURES_MAX = 10
#: Interval (s) at which a waiting caller checks if the node's thread is alive.
_LOOK_EVERY_S = 0.5
#: Timeout (s) for the end of its thread.
_END_S = 1.0


class RclpyBackend:
    """Node of ``rclpy`` in a context of its own, so that scripts may use ``rclpy`` too."""

    name = "rclpy"

    def __init__(self):
        self.classes = Classes()
        self.context = Context()
        self.node = None
        self.executor = None
        self.liveness = None
        self._listener = None
        self._thread = None
        self._closed = False
        self._todo = []
        self._lock = threading.Lock()

    def start(self, settings, listener):
        """Create the node and its thread."""
        self._listener = listener
        try:
            rclpy.init(args=[], context=self.context, domain_id=settings.domain, signal_handler_options=_no_signals())
            self.node = Node(settings.name, namespace=settings.namespace, context=self.context, use_global_arguments=False)
            self.executor = SingleThreadedExecutor(context=self.context)
            self.executor.add_node(self.node)
        except Exception as error:
            raise RosError(f"rclpy cannot make a node: {error}") from error
        self._guard = self.node.create_guard_condition(self._do, callback_group=ReentrantCallbackGroup())
        domain = int(os.environ.get("ROS_DOMAIN_ID") or 0) if settings.domain is None else settings.domain
        self.liveness = Liveness(domain)
        if rclpy.get_rmw_implementation_identifier().startswith("rmw_fastrtps") and is_wanted():
            self.liveness.greet(self._key())
        self._thread = threading.Thread(target=self._spin, name="ros", daemon=True)
        self._thread.start()

    def _key(self):
        """Key of this process's participant, or None."""
        own = self.node.get_name(), self.node.get_namespace()
        ends = self.node.get_publishers_info_by_topic(_OF_EACH_NODE)
        return next((bytes(each.endpoint_gid)[:12] for each in ends if (each.node_name, each.node_namespace) == own), None)

    def _spin(self):
        failures = 0
        while not self._closed:
            try:
                self.executor.spin_once()
                failures = 0
            except ExternalShutdownException:
                return self._lose("its context was shut down")
            except Exception as error:
                # Destroying an entity during a wait raises occasionally.
                failures += 1
                self._listener.say("debug", f"{type(error).__name__}: {error}")
                if failures >= _FAILURES_MAX:
                    return self._lose(f"{type(error).__name__}: {error}")
        return None

    def _lose(self, why):
        if not self._closed:
            self._closed = True
            self._listener.lost(why)

    def on_thread(self, function):
        """Call a function on the node's thread; return its result or raise its exception.

        `rclpy` cannot create objects on another thread while the node's thread spins.
        """
        if threading.current_thread() is self._thread:
            return function()
        answers, come = [], threading.Event()

        def call():
            try:
                answers.append((function(), None))
            except Exception as error:
                answers.append((None, error))
            come.set()

        self.post(call)
        while not come.wait(_LOOK_EVERY_S):
            self.check()
        value, error = answers[0]
        if error is not None:
            raise error
        return value

    def post(self, function, *arguments):
        """Call a function on the node's thread, without waiting.

        Only that thread may use objects without locks of their own.
        """
        self.check()
        with self._lock:
            self._todo.append((function, arguments))
        self._guard.trigger()

    def _do(self):
        with self._lock:
            todo, self._todo = self._todo, []
        for function, arguments in todo:
            try:
                function(*arguments)
            except Exception as error:
                self._listener.say("error", f"{type(error).__name__}: {error}")

    def check(self):
        """Raise :class:`BackendLost` if the node has ended."""
        if self._closed:
            raise BackendLost("the ROS node has ended")

    def say(self, level, text):
        """Log a line."""
        self._listener.say(level, text)

    def close(self):
        """End the node and its thread."""
        if self._closed:
            return
        deliver(self.node.publishers)
        self._closed = True
        self.liveness.close()
        self._guard.trigger()
        self._thread.join(_END_S)
        self.executor.shutdown(timeout_sec=0)
        self.node.destroy_node()
        self.context.try_shutdown()

    def describe(self, type_name):
        """Type with all types that it contains, by name."""
        return self.classes.describe(type_name)

    def publisher(self, topic, type_name, qos):
        """Create a publisher."""
        known = self.classes.known(type_name)
        return self.on_thread(lambda: _Publisher(self, topic, known, _profile(qos)))

    def subscription(self, topic, type_name, qos, heard):
        """Subscribe to a topic."""
        known = self.classes.known(type_name)
        return self.on_thread(lambda: _Subscription(self, topic, known, _profile(qos), heard))

    def client(self, service, type_name):
        """Create a client of a service."""
        return self.on_thread(lambda: _Client(self, service, type_name))

    def service(self, name, type_name, asked):
        """Offer a service."""
        return self.on_thread(lambda: _Service(self, name, type_name, asked))

    def action_client(self, action, type_name):
        """Create a client of an action."""
        return self.on_thread(lambda: _made(f"send goals to {action} ({type_name})", lambda: ActionClient(self, action, type_name)))

    def action_server(self, name, type_name, asked):
        """Offer an action."""
        return self.on_thread(lambda: _made(f"offer {name} ({type_name})", lambda: ActionServer(self, name, type_name, asked)))

    def publishers_of(self, topic):
        """Known publishers on a topic."""
        self.check()
        return [_endpoint(each) for each in self.node.get_publishers_info_by_topic(topic)]

    def subscriptions_of(self, topic):
        """Known subscriptions of a topic."""
        self.check()
        return [_endpoint(each) for each in self.node.get_subscriptions_info_by_topic(topic)]

    def topics(self):
        """All known topics, with their types."""
        self.check()
        return {name: tuple(types) for name, types in self.node.get_topic_names_and_types()}

    def services(self):
        """All known services, with their types."""
        self.check()
        return {name: tuple(types) for name, types in self.node.get_service_names_and_types()}

    def nodes(self):
        """Names of all known nodes."""
        self.check()
        return [_joined(space, name) for name, space in self.node.get_node_names_and_namespaces()]

    def serving(self, service):
        """Nodes that offer a service, as (name, namespace)."""
        found = set()
        for name, space in self.node.get_node_names_and_namespaces():
            try:
                offered = self.node.get_service_names_and_types_by_node(name, space)
            except Exception:  # noqa: S112, the node has gone in between
                continue
            if any(each == service for each, _ in offered):
                found.add((name, space))
        return found

    def participants(self, nodes):
        """Keys of the participants of nodes, for :mod:`rafcon.ros._liveness`; None if unknown.

        A node that died and was restarted has two, until the lease of the first expires.
        """
        known = {}
        for each in self.node.get_publishers_info_by_topic(_OF_EACH_NODE):
            known.setdefault((each.node_name, each.node_namespace), set()).add(bytes(each.endpoint_gid)[:12])
        return set().union(*(known.get(each, {None}) for each in nodes))


def _no_signals():
    from rclpy.signals import SignalHandlerOptions

    return SignalHandlerOptions.NO


def _profile(qos):
    return QoSProfile(
        reliability=ReliabilityPolicy.RELIABLE if qos.reliability == "reliable" else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if qos.durability == "transient_local" else DurabilityPolicy.VOLATILE,
        history=HistoryPolicy.KEEP_LAST if qos.depth else HistoryPolicy.KEEP_ALL,
        depth=qos.depth,
    )


def services():
    """Quality of service of clients. The default of ROS 2 only queues ten responses."""
    return QoSProfile(depth=_ANSWERS_MAX, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.VOLATILE)


def _endpoint(info):
    policies = info.qos_profile
    reliable = policies.reliability != ReliabilityPolicy.BEST_EFFORT
    latched = policies.durability == DurabilityPolicy.TRANSIENT_LOCAL
    qos = Qos("reliable" if reliable else "best_effort", "transient_local" if latched else "volatile", 10)
    known = info.node_name and not info.node_name.startswith("_NODE_NAME_UNKNOWN_")
    return Endpoint(_joined(info.node_namespace, info.node_name) if known else "", info.topic_type, qos)


def _joined(space, name):
    return f"{space.rstrip('/')}/{name}"


def _made(what, make):
    try:
        return make()
    except RosError:
        raise
    except Exception as error:
        raise RosError(f"cannot {what}: {str(error).partition(', at /')[0]}") from error


def _made_on_topic(backend, what, topic, type_name, make):
    try:
        return _made(f"{what} {type_name} on {topic}", make)
    except RosError as error:
        own = backend.node.get_fully_qualified_name()
        others = {each.type_name for each in backend.publishers_of(topic) + backend.subscriptions_of(topic) if each.node == own}
        for other in others - {type_name}:
            raise RosError(f"cannot {what} {type_name} on {topic}: this run uses it as {other} already") from error
        raise


class _Part:
    """Object of the node that is destroyed on the node's thread."""

    def __init__(self, backend):
        backend.check()
        self._backend = backend
        self._open = True

    def _destroy(self):
        raise NotImplementedError

    def close(self):
        """Release it."""
        if self._open:
            self._open = False
            if not self._backend._closed:
                self._backend.post(self._destroy)


class _Publisher(_Part):
    """Publisher of ``rclpy``."""

    def __init__(self, backend, topic, known, profile):
        _Part.__init__(self, backend)
        self._known = known
        self._publisher = _made_on_topic(backend, "publish", topic, known.type.name, lambda: backend.node.create_publisher(known.cls, topic, profile))

    def publish(self, message):
        """Send a message."""
        self._backend.check()
        self._publisher.publish(self._known.made(message))

    def subscribers(self):
        """Number of subscriptions."""
        self._backend.check()
        return self._publisher.get_subscription_count()

    def _destroy(self):
        self._backend.node.destroy_publisher(self._publisher)


class _Subscription(_Part):
    """Subscription of ``rclpy``."""

    def __init__(self, backend, topic, known, profile, heard):
        _Part.__init__(self, backend)
        self._known = known
        self._heard = heard
        self._topic = topic
        arguments, group = (known.cls, topic, self._hear, profile), ReentrantCallbackGroup()
        make = backend.node.create_subscription
        made = lambda: make(*arguments, callback_group=group)  # noqa: E731
        self._subscription = _made_on_topic(backend, "hear", topic, known.type.name, made)

    def _hear(self, message):
        if self._open:
            self._heard(self._known.plain(message))

    def publishers(self):
        """Number of publishers."""
        self._backend.check()
        return self._backend.node.count_publishers(self._topic)

    def _destroy(self):
        self._backend.node.destroy_subscription(self._subscription)


class Servers:
    """Processes that offer a service according to the graph, without those that have ended."""

    def __init__(self, backend, service, is_ready):
        self._backend = backend
        self._service = service
        self._is_ready = is_ready
        self._nodes = set()

    def alive(self, sent_s):
        """Keys of live participants; None for unknown ones.

        Excludes participants that replaced a dead one after ``sent_s``.
        """
        self._backend.check()
        if not self._is_ready():
            self._nodes = set()
            return set()
        alive = self._of_nodes() if self._nodes else set()
        if not alive:
            # A new server may have appeared since the last query of the nodes.
            self._nodes = self._backend.serving(self._service)
            alive = self._of_nodes() if self._nodes else {None}
        return {key for key in alive if key is None or self._backend.liveness.replaced_s(key) <= sent_s}

    def _of_nodes(self):
        keys = self._backend.participants(self._nodes)
        return {key for key in keys if key is None or not self._backend.liveness.has_ended(key)}


class _Client(_Part):
    """Client of ``rclpy``."""

    def __init__(self, backend, service, type_name):
        _Part.__init__(self, backend)
        self._request = backend.classes.known(type_name + "_Request")
        self._response = backend.classes.known(type_name + "_Response")
        group = ReentrantCallbackGroup()
        make = backend.node.create_client
        self._client = _made(f"call {service} ({type_name})", lambda: make(interface(type_name), service, qos_profile=services(), callback_group=group))
        self._servers = Servers(backend, service, self._client.service_is_ready)

    def servers(self, sent_s=math.inf):
        """Processes of the servers."""
        return self._servers.alive(sent_s)

    def send(self, request, done):
        """Send a request."""
        self._backend.check()
        future = self._client.call_async(self._request.made(request))
        pending = _Pending(self._client, future)

        def come(_future):
            if pending.open and not future.cancelled():
                error = future.exception()
                done(*((self._response.plain(future.result()), None) if error is None else (None, str(error))))

        future.add_done_callback(come)
        return pending

    def _destroy(self):
        self._backend.node.destroy_client(self._client)


class _Pending:
    """Request that was sent."""

    def __init__(self, client, future):
        self.open = True
        self._client = client
        self._future = future

    def close(self):
        """Stop waiting for the response."""
        if self.open:
            self.open = False
            if not self._future.done():
                self._client.remove_pending_request(self._future)


class _Service(_Part):
    """Service of ``rclpy`` with deferred responses."""

    def __init__(self, backend, name, type_name, asked):
        _Part.__init__(self, backend)
        request, response = (backend.classes.known(f"{type_name}_{part}") for part in ("Request", "Response"))

        def take(message, _response):
            return _Request(backend, request.plain(message), response)

        group = ReentrantCallbackGroup()
        make = backend.node.create_service
        self._service = _made(f"offer {name} ({type_name})", lambda: make(interface(type_name), name, take, callback_group=group))
        send = self._service.send_response

        def later(taken, header):
            taken._send = lambda answer: send(answer, header)
            if self._open:
                asked(taken)

        # `rclpy` sends the return value of the callback. Here that is the request itself; the response is sent when it is
        # known.
        self._service.send_response = later

    def _destroy(self):
        self._backend.node.destroy_service(self._service)


class _Request:
    """Received request."""

    def __init__(self, backend, request, response):
        self.request = request
        self._backend = backend
        self._response = response
        self._send = None

    def answer(self, response):
        """Send the response."""
        self._backend.post(lambda: self._send(self._response.made(response)))


def new_goal_id():
    """Create a unique id of 16 bytes."""
    return uuid.uuid4().bytes
