"""Outputs of a child can flow to the decider and to the outputs of the barrier."""


def execute(self, inputs, outputs, gvm):
    self.preemptive_wait(0.1)
    outputs["temperature_c"] = 41.5
    return "success"
