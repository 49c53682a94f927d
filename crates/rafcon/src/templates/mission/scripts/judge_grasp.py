"""Handles the error of the grasp: once more, or not."""


def execute(self, inputs, outputs, gvm):
    self.logger.warning("attempt %d: %s", inputs["attempt"], inputs.get("error"))
    return "again" if inputs["attempt"] < inputs["attempts"] else "enough"
