"""The slowest test: the barrier waits for it."""


def execute(self, inputs, outputs, gvm):
    for joint in range(1, 8):
        if self.preemptive_wait(0.03):
            return "preempted"
        self.logger.debug("joint %d moves", joint)
    return "success"
