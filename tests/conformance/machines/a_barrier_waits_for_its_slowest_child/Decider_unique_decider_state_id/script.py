def execute(self, inputs, outputs, gvm):
    self.logger.info('all are here')
    return 0
