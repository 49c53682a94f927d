"""A sector that was left to charge is entered again: what was seen is not visited twice."""


def execute(self, inputs, outputs, gvm):
    visited = inputs["waypoint"] in gvm.get_variable("waypoints")
    return "visited" if visited else "new"
