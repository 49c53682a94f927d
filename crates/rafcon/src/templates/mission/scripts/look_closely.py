"""Looks at one spot of the ground; the thing is at the second or third."""


def execute(self, inputs, outputs, gvm):
    if self.preemptive_wait(1.0 * gvm.get_variable("time_scale")):
        return "preempted"
    spot = 2 + gvm.get_variable("seed") % 2
    outputs["looks"] = inputs["looks"] + 1
    return "there it is" if outputs["looks"] >= spot else "not here"
