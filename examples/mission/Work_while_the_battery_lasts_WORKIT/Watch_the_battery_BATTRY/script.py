"""Runs beside the work until it is preempted, or until the battery is nearly empty."""

LOW = 15.0


def execute(self, inputs, outputs, gvm):
    while not self.preemptive_wait(0.02):
        level = gvm.get_variable("battery") - 0.2
        gvm.set_variable("battery", level)
        if level < LOW:
            return "low"
    return "preempted"
