"""Drives along the path. Sand makes the wheels slip at times: then the robot stands somewhere else."""

import random

SPEED_M_S = 1.0
SLIPS = 0.1


class WheelsSlipped(Exception):
    """The robot is not where it wanted to be."""


def execute(self, inputs, outputs, gvm):
    seconds = 1.0 + inputs["length_m"] / SPEED_M_S
    if self.preemptive_wait(seconds * gvm.get_variable("time_scale")):
        return "preempted"
    level = gvm.get_variable("battery") - 2.0 - 0.3 * inputs["length_m"]
    gvm.set_variable("battery", max(level, 1.0))
    gvm.set_variable("position", (inputs["x_m"], inputs["y_m"]))
    if chance(self, gvm) < SLIPS:
        raise WheelsSlipped("the wheels slip in the sand")
    return "success"


def chance(self, gvm):
    """The same number in every run with this seed, another one each time this state is entered."""
    entered = self.persistent_variables.get("entered", 0) + 1
    self.persistent_variables["entered"] = entered
    return random.Random(f"{gvm.get_variable('seed')} {self.get_path()} {entered}").random()
