"""Runs on preemption: the transition from `preempted` of the state before leads here."""


def execute(self, inputs, outputs, gvm):
    outputs["arm"] = "folded"
    self.logger.info("the camera arm is folded")
    return "success"
