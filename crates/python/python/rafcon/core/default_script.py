"""Script of a new execution state."""


def execute(self, inputs, outputs, gvm):
    """Log a greeting, wait for two seconds, and leave by *success*."""
    self.logger.info("Hello {}".format(self.name))
    self.preemptive_wait(2)
    return "success"
