"""What a new execution state does."""


def execute(self, inputs, outputs, gvm):
    """Greets, waits for two seconds, and ends by *success*."""
    self.logger.info("Hello {}".format(self.name))
    self.preemptive_wait(2)
    return "success"
