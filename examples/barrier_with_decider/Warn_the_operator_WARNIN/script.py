"""What a child of the barrier raised has become plain data by now."""


def execute(self, inputs, outputs, gvm):
    self.logger.warning("the robot is not at its best: %s", inputs["report"])
    return "success"
