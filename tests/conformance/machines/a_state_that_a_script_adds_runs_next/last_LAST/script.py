def execute(self, inputs, outputs, gvm):
    self.logger.info('%s', repr((inputs.get('value'),)))
    return 0
