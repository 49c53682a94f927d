import math

from rafcon import ros


def execute(self, inputs, outputs, gvm):
    half = inputs["yaw"] / 2
    pose = {"position": {"x": inputs["x"], "y": inputs["y"]}, "orientation": {"z": math.sin(half), "w": math.cos(half)}}
    goal = {
        "pose": {"header": {"frame_id": inputs["frame"], "stamp": ros.stamp()}, "pose": pose},
        "behavior_tree": inputs["behavior_tree"],
    }
    ended = ros.action(inputs["action"], goal, "nav2_msgs/action/NavigateToPose", timeout=inputs["timeout"] or None)
    result = ended.result or {}
    outputs["distance"] = ended.feedback and ended.feedback["distance_remaining"]
    outputs["why"] = ended.why or result.get("error_msg", "")
    return ended.outcome
