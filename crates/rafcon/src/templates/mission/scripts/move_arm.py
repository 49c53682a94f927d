"""The arm moves to the pose that this state is named after."""


def execute(self, inputs, outputs, gvm):
    if self.preemptive_wait(1.5 * gvm.get_variable("time_scale")):
        return "preempted"
    return "success"
