def execute(self, inputs, outputs, gvm):
    print('one')
    print('two')
    self.logger.warning('three')
    return 0
