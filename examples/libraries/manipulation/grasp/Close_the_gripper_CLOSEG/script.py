"""A slip raises: the outcome `aborted` leads to the state that opens the gripper again."""


class Slipped(Exception):
    """The thing is still on the table."""


def execute(self, inputs, outputs, gvm):
    outputs["attempt"] = inputs["attempt"] + 1
    if self.preemptive_wait(0.01):
        return "preempted"
    slips = gvm.get_variable("slips", default=0)
    if slips > 0:
        gvm.set_variable("slips", slips - 1)
        raise Slipped(inputs["thing"])
    gvm.set_variable("in the gripper", inputs["thing"])
    return "success"
