"""The topic with the state of the runs, for all programs of ROS: of a type that each of them knows."""

from rafcon import ros
from rafcon.ros import RosError

STATE = "state"
TYPE = "diagnostic_msgs/msg/DiagnosticArray"
OK, WARN, ERROR = 0, 1, 2


class Topic:
    """``state``: latched, so that who comes late has it at once."""

    def __init__(self, tell):
        self._tell = tell
        self._is_known = True

    def publish(self, runs):
        """Tells how the runs stand."""
        if not self._is_known:
            return
        try:
            message = {"header": {"stamp": ros.stamp()}, "status": [status_of(each) for each in runs]}
            ros.publish(STATE, message, TYPE, qos="latched", wait=0)
        except RosError as error:
            self._is_known = False
            self._tell(f"the topic {STATE} is not published: {error}")


def status_of(run):
    """A run as a status of ``diagnostic_msgs``."""
    values = [("run", run.id), ("machine", run.machine), ("status", run.status), ("outcome", run.outcome)]
    values += [("robot", run.robot)] if run.robot else []
    values += [("active", each) for each in run.active]
    words = run.outcome or run.reason or ", ".join(run.active)
    return {
        "level": _level(run),
        "name": f"rafcon: {run.machine or run.name}",
        "message": f"{run.status}: {words}" if words else run.status,
        "hardware_id": run.id,
        "values": [{"key": key, "value": value} for key, value in values],
    }


def _level(run):
    if run.is_live:
        return WARN if run.status in ("paused", "stepping") else OK
    return ERROR if run.phase != "finished" or run.outcome == "aborted" else WARN if run.outcome == "preempted" else OK
