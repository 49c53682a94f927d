def execute(self, inputs, outputs, gvm):
    self.logger.info('clean up %s', self.name)
    return 0
