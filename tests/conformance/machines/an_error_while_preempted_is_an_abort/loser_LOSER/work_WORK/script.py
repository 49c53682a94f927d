def execute(self, inputs, outputs, gvm):
    self.preemptive_wait(20)
    raise ValueError('late')
