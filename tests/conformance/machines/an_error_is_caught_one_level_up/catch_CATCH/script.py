def execute(self, inputs, outputs, gvm):
    self.logger.info('%r', inputs.get('error'))
    return 0
