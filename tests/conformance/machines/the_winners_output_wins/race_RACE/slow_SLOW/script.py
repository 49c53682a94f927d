def execute(self, inputs, outputs, gvm):
    self.preemptive_wait(20)
    outputs['value'] = 'loser'
    return 0
