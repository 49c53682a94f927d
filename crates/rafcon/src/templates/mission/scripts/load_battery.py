"""Loads until the battery is full."""


def execute(self, inputs, outputs, gvm):
    level = gvm.get_variable("battery")
    while level < 100.0:
        if self.preemptive_wait(1.0 * gvm.get_variable("time_scale")):
            return "preempted"
        level = min(level + 10.0, 100.0)
        gvm.set_variable("battery", level)
    return "success"
