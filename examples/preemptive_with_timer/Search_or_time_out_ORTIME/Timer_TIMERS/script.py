"""Ends after the time limit, unless the search ends first."""


def execute(self, inputs, outputs, gvm):
    if self.preemptive_wait(inputs["limit_s"]):
        return "preempted"
    return "time is up"
