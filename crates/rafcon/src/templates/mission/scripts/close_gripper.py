"""Closes the gripper. What is round slips away at times."""

import random

SLIPS = 0.4


class GraspSlipped(Exception):
    """The gripper is empty."""


def execute(self, inputs, outputs, gvm):
    outputs["attempt"] = inputs["attempt"] + 1
    if self.preemptive_wait(1.0 * gvm.get_variable("time_scale")):
        return "preempted"
    if chance(self, gvm) < SLIPS:
        raise GraspSlipped(f"the {inputs['thing']} slips")
    gvm.set_variable("in the gripper", inputs["thing"])
    return "success"


def chance(self, gvm):
    """The same number in every run with this seed, another one each time this state is entered."""
    entered = self.persistent_variables.get("entered", 0) + 1
    self.persistent_variables["entered"] = entered
    return random.Random(f"{gvm.get_variable('seed')} {self.get_path()} {entered}").random()
