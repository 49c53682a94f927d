"""The charger stands at the base."""


def execute(self, inputs, outputs, gvm):
    if self.preemptive_wait(2.0 * gvm.get_variable("time_scale")):
        return "preempted"
    return "success"
