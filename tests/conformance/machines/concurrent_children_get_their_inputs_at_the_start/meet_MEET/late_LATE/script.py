def execute(self, inputs, outputs, gvm):
    self.preemptive_wait(0.2)
    outputs['sum'] = inputs['number'] + 1
    return 0
