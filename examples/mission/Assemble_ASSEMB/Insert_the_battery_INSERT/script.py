"""Short and careful."""


def execute(self, inputs, outputs, gvm):
    if self.preemptive_wait(0.05):
        return "preempted"
    outputs["sound"] = "click"
    return "success"
