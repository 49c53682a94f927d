"""The right arm inserts the battery; at the first attempt it stands askew."""


def execute(self, inputs, outputs, gvm):
    if self.preemptive_wait(2.0 * gvm.get_variable("time_scale")):
        return "preempted"
    outputs["askew_deg"] = 0.5 if inputs["realigned"] else 7.0
    return "success"
