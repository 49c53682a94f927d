"""Nothing to do but wait: the mission goes on meanwhile."""


def execute(self, inputs, outputs, gvm):
    self.logger.warning("no link to the ground station")
    if self.preemptive_wait(max(0.01, 3.0 * gvm.get_variable("time_scale"))):
        return "preempted"
    return "success"
