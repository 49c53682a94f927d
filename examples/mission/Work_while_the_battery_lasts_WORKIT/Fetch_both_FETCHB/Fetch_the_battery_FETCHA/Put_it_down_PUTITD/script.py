"""What is in the gripper goes on the table of the base."""


def execute(self, inputs, outputs, gvm):
    table = gvm.get_variable("on the table", default=[])
    gvm.set_variable("on the table", [*table, gvm.get_variable("in the gripper")])
    return "success"
