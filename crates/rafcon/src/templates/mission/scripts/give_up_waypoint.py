"""The robot cannot get there; the survey goes on without it."""


def execute(self, inputs, outputs, gvm):
    gvm.get_variable("waypoints")[inputs["waypoint"]] = "out of reach"
    self.logger.warning("waypoint %d is left out: %s", inputs["waypoint"], inputs.get("error"))
    return "success"
