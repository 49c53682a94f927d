def execute(self, inputs, outputs, gvm):
    self.preemptive_wait(0.3)
    self.logger.info('slow')
    return 0
