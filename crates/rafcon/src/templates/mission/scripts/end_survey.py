"""Tells the states that run beside the survey that they may end."""


def execute(self, inputs, outputs, gvm):
    gvm.set_variable("surveying", False)
    seen = list(gvm.get_variable("waypoints").values()).count("seen")
    self.logger.info("%d waypoints were seen", seen)
    outputs["seen"] = seen
    return "success"
