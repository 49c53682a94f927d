"""One scan for the map, as long as the survey lasts."""


def execute(self, inputs, outputs, gvm):
    if not gvm.get_variable("surveying"):
        return "the survey is over"
    if self.preemptive_wait(max(0.02, 4.0 * gvm.get_variable("time_scale"))):
        return "preempted"
    return "success"
