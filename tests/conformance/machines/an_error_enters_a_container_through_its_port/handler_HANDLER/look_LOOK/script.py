def execute(self, inputs, outputs, gvm):
    self.logger.info('%s', repr((inputs.get('problem'),)))
    return 0
