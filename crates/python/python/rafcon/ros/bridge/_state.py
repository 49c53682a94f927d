"""Topics with the states of runs, of a type that is available to all programs of ROS."""

from rafcon import ros
from rafcon.ros import RosError

STATE = "state"
TYPE = "diagnostic_msgs/msg/DiagnosticArray"
OK, WARN, ERROR = 0, 1, 2


class Topic:
    """Latched topic about the runs, so that late subscribers receive it at once."""

    def __init__(self, name, type_name, message_of, tell):
        self._name = name
        self._type_name = type_name
        self._message_of = message_of
        self._tell = tell
        self._is_known = True

    def publish(self, runs):
        """Publish the states of the runs."""
        if not self._is_known:
            return
        try:
            ros.publish(self._name, self._message_of(runs), self._type_name, qos="latched", wait=0)
        except RosError as error:
            self._is_known = False
            self._tell(f"the topic {self._name} is not published: {error}")


def state_of(runs):
    """Convert all runs to a message of ``diagnostic_msgs``."""
    return {"header": {"stamp": ros.stamp()}, "status": [status_of(each) for each in runs]}


def status_of(run):
    """Convert a run to a status of ``diagnostic_msgs``."""
    values = [("run", run.id), ("machine", run.machine), ("status", run.status), ("outcome", run.outcome)]
    values += [("robot", run.robot)] if run.robot else []
    values += [("active", each) for each in run.active]
    words = run.outcome or run.reason or ", ".join(run.active)
    return {
        "level": level_of(run),
        "name": f"rafcon: {run.machine or run.name}",
        "message": f"{run.status}: {words}" if words else run.status,
        "hardware_id": run.id,
        "values": [{"key": key, "value": value} for key, value in values],
    }


def level_of(run):
    """Level of a run, as in ``diagnostic_msgs``."""
    if run.is_live:
        return WARN if run.status in ("paused", "stepping") else OK
    return ERROR if run.phase != "finished" or run.outcome == "aborted" else WARN if run.outcome == "preempted" else OK
