"""Runs after all others: sees how each child ended, and its error if it had one."""

CHILDREN = ("Test the camera", "Test the arm", "Test the gripper")


def execute(self, inputs, outputs, gvm):
    failed = [name for name in CHILDREN if self.get_outcome_for_state_name(name).name != "success"]
    errors = [f"{name}: {self.get_errors_for_state_name(name)}" for name in failed]
    outputs["report"] = "; ".join(errors) or "all devices work"
    if inputs["temperature_c"] > 60.0:
        outputs["report"] += "; the camera is too hot"
        return "some fail"
    return "some fail" if failed else "all well"
