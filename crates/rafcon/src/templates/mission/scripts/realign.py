"""Turns the battery, and says so to the next attempt."""


def execute(self, inputs, outputs, gvm):
    if self.preemptive_wait(1.0 * gvm.get_variable("time_scale")):
        return "preempted"
    outputs["realigned"] = True
    return "success"
