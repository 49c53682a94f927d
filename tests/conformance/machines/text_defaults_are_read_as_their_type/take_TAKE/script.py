def execute(self, inputs, outputs, gvm):
    self.logger.info('%s', repr((inputs.get('number'), inputs.get('real'), inputs.get('truth'), inputs.get('items'), inputs.get('table'), inputs.get('anything'), inputs.get('text'), inputs.get('nothing'),)))
    return 0
