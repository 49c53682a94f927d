"""The left arm holds the mug as long as the right one needs."""


def execute(self, inputs, outputs, gvm):
    if self.preemptive_wait(3.0 * gvm.get_variable("time_scale")):
        return "preempted"
    return "success"
