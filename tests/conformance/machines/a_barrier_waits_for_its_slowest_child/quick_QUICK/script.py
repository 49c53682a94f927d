def execute(self, inputs, outputs, gvm):
    self.logger.info('quick')
    return 0
