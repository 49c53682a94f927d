"""Holding takes as long as inserting does; the barrier waits for both."""


def execute(self, inputs, outputs, gvm):
    return "preempted" if self.preemptive_wait(0.1) else "success"
