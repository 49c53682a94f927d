def execute(self, inputs, outputs, gvm):
    self.logger.info('decided')
    return 0
