"""A path from where the robot is to the goal; a rock at the goal leaves none."""

import math


class NoPath(Exception):
    """There is no way to the goal."""


def execute(self, inputs, outputs, gvm):
    if self.preemptive_wait(0.5 * gvm.get_variable("time_scale")):
        return "preempted"
    if inputs["waypoint"] in gvm.get_variable("rocks"):
        raise NoPath(f"a rock stands at waypoint {inputs['waypoint']}")
    x, y = gvm.get_variable("position")
    outputs["length_m"] = math.hypot(inputs["x_m"] - x, inputs["y_m"] - y)
    return "success"
