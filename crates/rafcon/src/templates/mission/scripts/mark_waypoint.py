"""This waypoint is done."""


def execute(self, inputs, outputs, gvm):
    gvm.get_variable("waypoints")[inputs["waypoint"]] = "seen"
    return "success"
