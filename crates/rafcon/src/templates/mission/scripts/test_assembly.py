"""A last look at the work."""


def execute(self, inputs, outputs, gvm):
    if self.preemptive_wait(1.0 * gvm.get_variable("time_scale")):
        return "preempted"
    outputs["assembled"] = True
    return "success"
