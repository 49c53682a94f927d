"""The whole bridge, which offers actions, services and topics while its server runs."""

import contextlib
import os
import threading

from rafcon import ros
from rafcon.ros import RosError, _native_helper, _node
from rafcon.ros._types import full_name
from rafcon.ros.bridge import _goals, _machines, _mapping, _markers, _state
from rafcon.ros.bridge._client import Client, NoAnswer, Refused
from rafcon.ros.bridge._commands import Commands
from rafcon.ros.bridge._goals import Goals
from rafcon.ros.bridge._watch import Watch

RUN_MACHINE = "rafcon_msgs/action/RunMachine"
#: Ways to install the types of the bridge, if its back end does not know them.
WAY_OUT = (
    "build the package ros/rafcon_msgs of RAFCON in a workspace of ROS and source it, or put rafcon-ros beside rafcon, which has these types"
)
#: Time (s) for goals to send their last messages.
_LAST_WORDS_S = 1.0
#: Interval (s) of checks of the node.
_LOOK_S = 1.0


def tell(text):
    """Print a line for the program that started the server."""
    # A killed server no longer reads.
    with contextlib.suppress(OSError):
        print(f"ROS: {text}", flush=True)


class Bridge:
    """Bridge with its node, actions, services and topics."""

    def __init__(self, told):
        self._client = Client(told["server"], told["token"], told.get("fingerprint"))
        ros.configure(name="bridge", namespace=told["namespace"], backend=_backend())
        self._here = _node.node()
        self._news = threading.Event()
        self._topics = [
            _state.Topic(_state.STATE, _state.TYPE, _state.state_of, tell),
            _state.Topic(_markers.MARKERS, _markers.TYPE, lambda runs: _markers.markers_of(runs, told["frame"], ros.stamp()), tell),
        ]
        self._watch = Watch(self._client, self._looked, tell)
        self._goals = Goals(self._client, self._watch, self._here.types.build, tell)
        self._commands = Commands(self._client, self._watch, self._known)
        self._machines = []
        self._offered = {}
        self._run_machine = None
        self._said = set()
        self._server_is_gone = False

    def run(self, stream):
        """Serve until the stream or the node ends; return the exit code."""
        self._begin()
        threading.Thread(target=self._watch.run, name="ros runs", daemon=True).start()
        threading.Thread(target=self._read, args=(stream,), name="ros server", daemon=True).start()
        files = None
        while not self._server_is_gone and self._here.ended is None:
            if self._watch.files_revision != files:
                files = self._files_changed(self._watch.files_revision, files)
            self._news.wait(_LOOK_S)
            self._news.clear()
        if self._here.ended is not None:
            tell(f"the bridge ends, for its node has: {self._here.ended}")
            return 1
        self._goals.end("the server of RAFCON has ended", _LAST_WORDS_S)
        servers = [each for _declared, each in self._offered.values()] + ([self._run_machine] if self._run_machine else [])
        for server in servers:
            server.join(_LAST_WORDS_S)
        ros.close()
        return 0

    def _read(self, stream):
        while stream.readline():
            pass
        self._server_is_gone = True
        self._goals.over = "the server of RAFCON has ended"
        self._news.set()

    def _looked(self, runs):
        """Publish the runs if they have changed; called on the thread of the watch."""
        if runs is not None:
            for topic in self._topics:
                topic.publish(runs)
        self._news.set()

    def _begin(self):
        self._offer_run_machine()
        self._commands.offer(tell)
        place, by = self._here.settings.namespace, self._here.backend.name
        topics = " and ".join(map(self._here.absolute, (_state.STATE, _markers.MARKERS)))
        tell(f"machines are offered below {place}, by {by}: as actions, with services, and the topics {topics}")

    def _offer_run_machine(self):
        def ask(goal):
            return _goals.run_machine(goal, RUN_MACHINE, lambda text: _machines.chosen(self._known(), text))

        try:
            self._run_machine = ros.action_server("run_machine", self._goals.work, RUN_MACHINE, self._goals.accept("run_machine", ask))
        except RosError as error:
            tell(f"run_machine is not offered: {error}. Either {WAY_OUT}")

    def _known(self):
        """All machines on disk, including new ones."""
        self._machines = _machines.machines(self._client)
        return self._machines

    def _files_changed(self, revision, before):
        """Update the offered actions; return the processed revision of the files."""
        try:
            wanted = self._wanted()
        except (NoAnswer, Refused) as error:
            self._say(f"the machines are not known: {error}")
            return before
        for action in [each for each in self._offered if self._offered[each][0] != wanted.get(each)]:
            self._offered.pop(action)[1].close()
        for action, declared in wanted.items():
            if action not in self._offered:
                self._offer(action, declared)
        return revision

    def _wanted(self):
        wanted = {}
        for machine in self._known():
            try:
                declared = _machines.declared(machine)
                action = declared and self._here.absolute(declared.action)
            except (_machines.WrongDeclaration, RosError) as error:
                self._say(f"{machine.name} is no action: {error}")
                continue
            if action in wanted:
                self._say(f"{action} is declared by {wanted[action].machine.name} and by {machine.name}: the first of them is offered")
            elif declared is not None:
                wanted[action] = declared
        return wanted

    def _say(self, text):
        """Print a line once."""
        if text not in self._said:
            self._said.add(text)
            tell(text)

    def _offer(self, action, declared):
        try:
            type_name = full_name(declared.type, "action")
            self._here.types.require(type_name)
            goal, result, feedback = (self._here.types.get(f"{type_name}_{part}").fields for part in ("Goal", "Result", "Feedback"))
            texts = {each.name: each.type == "string" and each.kind == "one" for each in result}
            told = {each.name: each.kind != "one" for each in feedback if each.type == "string"}
            ask = _goals.of_declared(declared, type_name, texts, told)
            server = ros.action_server(action, self._goals.work, type_name, self._goals.accept(action, ask))
        except RosError as error:
            self._say(f"{action} of {declared.machine.name} is not offered: {error}")
            return
        self._offered[action] = declared, server
        names = [[each.name for each in part] for part in (goal, result)]
        for text in _mapping.complaints(action, *names, declared.inputs, declared.outputs):
            self._say(text)
        tell(f"{declared.machine.name} is the action {action} ({type_name})")


def _backend():
    """Select ``native``, which has the bridge's types, if available; None for the default."""
    if os.environ.get(_node.BACKEND_VARIABLE):
        return None
    try:
        _native_helper.found()
    except RosError:
        return None
    return "native"
