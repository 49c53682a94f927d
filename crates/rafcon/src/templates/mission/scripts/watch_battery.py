"""Runs beside the driving. It ends when the battery is low, and that preempts the driving."""

LOW = 20.0


def execute(self, inputs, outputs, gvm):
    while gvm.get_variable("battery") > LOW:
        if self.preemptive_wait(max(0.01, gvm.get_variable("time_scale"))):
            return "preempted"
    self.logger.warning("the battery is at %.0f %%", gvm.get_variable("battery"))
    return "low"
