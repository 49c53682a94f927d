"""Tells the ground station where the robot is. Behind a hill the link is lost at times."""

import random

LOST = 0.2


def execute(self, inputs, outputs, gvm):
    if not gvm.get_variable("surveying"):
        return "the survey is over"
    if self.preemptive_wait(max(0.02, 6.0 * gvm.get_variable("time_scale"))):
        return "preempted"
    return "no link" if chance(self, gvm) < LOST else "sent"


def chance(self, gvm):
    """The same number in every run with this seed, another one each time this state is entered."""
    entered = self.persistent_variables.get("entered", 0) + 1
    self.persistent_variables["entered"] = entered
    return random.Random(f"{gvm.get_variable('seed')} {self.get_path()} {entered}").random()
