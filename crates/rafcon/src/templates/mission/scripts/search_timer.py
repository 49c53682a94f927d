"""A search that takes too long is given up. There are always two seconds, however fast the simulation runs."""


def execute(self, inputs, outputs, gvm):
    limit_s = inputs["limit_s"] * gvm.get_variable("time_scale")
    if self.preemptive_wait(2.0 + limit_s):
        return "preempted"
    return "time is up"
