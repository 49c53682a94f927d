def execute(self, inputs, outputs, gvm):
    self.logger.info('%s', repr((inputs.get('items'),)))
    return 0
