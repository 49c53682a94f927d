"""This robot is a simulation: two grasps will slip."""


def execute(self, inputs, outputs, gvm):
    gvm.set_variable("position", (0.0, 0.0))
    gvm.set_variable("battery", 100.0)
    gvm.set_variable("slips", 2)
    gvm.set_variable("on the table", [])
    return "success"
