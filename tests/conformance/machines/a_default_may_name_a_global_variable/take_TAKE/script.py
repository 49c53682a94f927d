def execute(self, inputs, outputs, gvm):
    self.logger.info('%s', repr((inputs.get('speed'), inputs.get('missing'),)))
    return 0
