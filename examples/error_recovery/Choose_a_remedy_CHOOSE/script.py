"""The error handler: the error that climbed up here stands in `inputs["error"]`."""

MAX_ATTEMPTS = 5


def execute(self, inputs, outputs, gvm):
    error = inputs["error"]
    self.logger.warning("attempt %d failed: %s", inputs["attempt"], error)
    if inputs["attempt"] >= MAX_ATTEMPTS:
        return "hopeless"
    return "reach again" if isinstance(error, TimeoutError) else "turn the plug"
