"""The error of the state before is found in `inputs["error"]`."""


def execute(self, inputs, outputs, gvm):
    error = inputs["error"]
    self.logger.warning("%s: %s, attempt %d", type(error).__name__, error, inputs["attempt"])
    return "again" if inputs["attempt"] < inputs["attempts"] else "enough"
