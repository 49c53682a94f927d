"""Runs when the drive is preempted: the one thing that is still done."""


def execute(self, inputs, outputs, gvm):
    self.logger.debug("the wheels stand still")
    return "success"
