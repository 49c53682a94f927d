def execute(self, inputs, outputs, gvm):
    self.logger.info('preempted: %s', self.preemptive_wait(20))
    return 0
