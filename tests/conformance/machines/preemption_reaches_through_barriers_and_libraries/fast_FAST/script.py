def execute(self, inputs, outputs, gvm):
    self.preemptive_wait(0.2)
    return 0
