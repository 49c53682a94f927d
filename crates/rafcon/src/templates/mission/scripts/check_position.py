"""Compares landmarks with the map; sometimes they do not match."""

import random

DRIFTS = 0.06


def execute(self, inputs, outputs, gvm):
    if self.preemptive_wait(0.5 * gvm.get_variable("time_scale")):
        return "preempted"
    return "lost" if chance(self, gvm) < DRIFTS else "there"


def chance(self, gvm):
    """The same number in every run with this seed, another one each time this state is entered."""
    entered = self.persistent_variables.get("entered", 0) + 1
    self.persistent_variables["entered"] = entered
    return random.Random(f"{gvm.get_variable('seed')} {self.get_path()} {entered}").random()
