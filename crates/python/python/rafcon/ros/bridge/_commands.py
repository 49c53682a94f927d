"""Services: lists of machines and runs, and commands for a run."""

import contextlib
import uuid

from rafcon import ros
from rafcon.ros import RosError
from rafcon.ros.bridge._client import NoAnswer, Refused

LIST, COMMAND, TRIGGER = "rafcon_msgs/srv/List", "rafcon_msgs/srv/Command", "std_srvs/srv/Trigger"
#: Commands by their names in requests.
COMMANDS = {
    "pause": "pause",
    "resume": "resume",
    "stop": "stop",
    "step": "step_into",
    "step_into": "step_into",
    "step_over": "step_over",
    "step_out": "step_out",
}
#: Services without a request, for the only run in progress.
SHORT = ("pause", "resume", "step", "stop")
#: Commands that need control; it is released afterwards, because nobody hands it over here.
_WITH_CONTROL = ("resume", "step_into", "step_over", "step_out")
#: Timeout (s); a stop may have to end the runner's process.
_COMMAND_S = 35.0


class Commands:
    """Services of the bridge."""

    def __init__(self, client, watch, machines):
        self._client = client
        self._watch = watch
        self._machines = machines

    def offer(self, tell):
        """Offer the services whose types are known."""
        callbacks = {name: (lambda _request, name=name: self.command("", name), TRIGGER) for name in SHORT}
        callbacks["command"] = lambda request: self.command(request.run, request.command), COMMAND
        callbacks["list"] = self._list, LIST
        for name, (callback, type_name) in callbacks.items():
            try:
                ros.serve(name, callback, type_name)
            except RosError as error:
                tell(f"the service {name} is not offered: {error}")

    def command(self, run, word):
        """Send a command to a run; an empty name selects the only run in progress."""
        try:
            command = COMMANDS.get(word)
            if command is None:
                return _answer(f"`{word}` is no command: write one of {', '.join(COMMANDS)}")
            run = run or self._only()
            answer = self._client.post(("runs", run, "commands"), {"id": _id(), "command": {"type": command}}, _COMMAND_S)
            if command in _WITH_CONTROL:
                self._release(run)
        except (Refused, NoAnswer) as error:
            return _answer(str(error))
        finally:
            self._watch.now()
        return _answer(answer.get("reason", "")) if answer.get("answer") == "refused" else {"success": True, "message": run}

    def _release(self, run):
        """Release control. A command that was refused has not taken it."""
        with contextlib.suppress(Refused):
            self._client.post(("runs", run, "control"), {"move": "release"})

    def _only(self):
        live = [each.id for each in self._watch.look() if each.is_live and not each.robot]
        if len(live) == 1:
            return live[0]
        if not live:
            raise Refused("no run is in progress")
        raise Refused(f"{len(live)} runs are in progress, {', '.join(live)}: name one of them, with the service `command`")

    def _list(self, _request):
        machines = [{"machine": each.name, "name": each.path.rpartition("/")[2]} for each in self._machines()]
        runs = [
            {"run": each.id, "machine": each.machine, "status": each.status, "outcome": each.outcome, "active": list(each.active)}
            for each in self._watch.look()
        ]
        return {"machines": machines, "runs": runs}


def _id():
    return f"ros-{uuid.uuid4().hex}"


def _answer(why):
    return {"success": False, "message": why}
