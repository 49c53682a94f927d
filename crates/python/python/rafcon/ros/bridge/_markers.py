"""Topic that displays the runs in progress in rviz: a text for each, above the robot."""

from rafcon.ros.bridge._state import OK, WARN, level_of

MARKERS = "markers"
TYPE = "visualization_msgs/msg/MarkerArray"
_TEXT, _ADD, _DELETE_ALL = 9, 0, 3
#: Height of a line, and of the lowest text above the frame, in m.
_LINE_M, _LOWEST_M = 0.15, 1.0
#: Colours of a run in progress.
_COLORS = {OK: (0.2, 0.8, 0.3), WARN: (1.0, 0.7, 0.1)}


def markers_of(runs, frame, stamp):
    """Message with a text for each run in progress, from the bottom up; deletes earlier texts."""
    header = {"frame_id": frame, "stamp": stamp}
    markers = [{"header": header, "ns": "rafcon", "action": _DELETE_ALL}]
    height_m = _LOWEST_M
    for number, run in enumerate(each for each in runs if each.is_live):
        lines = [f"{run.machine or run.name}: {run.status}", *run.active]
        # The position of a text is its centre.
        middle_m = height_m + len(lines) * _LINE_M / 2
        height_m += (len(lines) + 1) * _LINE_M
        red, green, blue = _COLORS[level_of(run)]
        markers.append(
            {
                "header": header,
                "ns": "rafcon",
                "id": number,
                "type": _TEXT,
                "action": _ADD,
                "pose": {"position": {"x": 0.0, "y": 0.0, "z": middle_m}, "orientation": {"w": 1.0}},
                "scale": {"z": _LINE_M},
                "color": {"r": red, "g": green, "b": blue, "a": 1.0},
                # Move the marker with the robot.
                "frame_locked": True,
                "text": "\n".join(lines),
            }
        )
    return {"markers": markers}
