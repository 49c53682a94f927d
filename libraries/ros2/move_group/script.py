from rafcon import ros


def execute(self, inputs, outputs, gvm):
    off = inputs["tolerance"]
    joints = [
        {"joint_name": name, "position": position, "tolerance_above": off, "tolerance_below": off, "weight": 1.0}
        for name, position in inputs["joints"].items()
    ]
    request = {
        "group_name": inputs["group"],
        "goal_constraints": [{"joint_constraints": joints}],
        "num_planning_attempts": 1,
        "allowed_planning_time": inputs["planning_time"],
        "max_velocity_scaling_factor": inputs["speed"],
        "max_acceleration_scaling_factor": inputs["speed"],
    }
    ended = ros.action(inputs["action"], {"request": request}, "moveit_msgs/action/MoveGroup", timeout=inputs["timeout"] or None)
    outputs["error_code"] = ended.result and ended.result["error_code"]["val"]
    outputs["why"] = ended.why or (f"MoveIt gives the error code {outputs['error_code']}" if ended.outcome == "aborted" else "")
    return ended.outcome
