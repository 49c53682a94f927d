"""What is in the gripper goes on the table of the base."""


def execute(self, inputs, outputs, gvm):
    if self.preemptive_wait(1.0 * gvm.get_variable("time_scale")):
        return "preempted"
    gvm.set_variable("fetched", [*gvm.get_variable("fetched"), gvm.get_variable("in the gripper")])
    gvm.set_variable("in the gripper", None)
    return "success"
