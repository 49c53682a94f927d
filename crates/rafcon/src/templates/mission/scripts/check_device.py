"""Every device of this robot works."""


def execute(self, inputs, outputs, gvm):
    if self.preemptive_wait(1.0 * gvm.get_variable("time_scale")):
        return "preempted"
    self.logger.debug("%s: works", inputs["device"])
    return "success"
