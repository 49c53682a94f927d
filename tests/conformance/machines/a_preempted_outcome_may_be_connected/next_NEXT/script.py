def execute(self, inputs, outputs, gvm):
    self.logger.info('went on')
    return 0
