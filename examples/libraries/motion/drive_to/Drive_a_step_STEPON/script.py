"""One step towards the goal."""

import math

STEP_M = 0.5


def execute(self, inputs, outputs, gvm):
    if self.preemptive_wait(inputs["step_s"]):
        return "preempted"
    x, y = gvm.get_variable("position", default=(0.0, 0.0))
    to_x, to_y = inputs["x_m"] - x, inputs["y_m"] - y
    left = math.hypot(to_x, to_y)
    outputs["driven_m"] = inputs["driven_m"]
    if left == 0.0:
        return "arrived"
    part = min(1.0, STEP_M / left)
    gvm.set_variable("position", (x + to_x * part, y + to_y * part))
    outputs["driven_m"] += left * part
    return "on the way"
