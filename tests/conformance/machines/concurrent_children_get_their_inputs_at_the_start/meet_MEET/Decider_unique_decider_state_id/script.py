def execute(self, inputs, outputs, gvm):
    self.logger.info('%s', inputs['sum'])
    return 0
