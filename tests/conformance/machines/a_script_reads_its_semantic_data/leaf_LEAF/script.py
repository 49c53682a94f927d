def execute(self, inputs, outputs, gvm):
    self.logger.info('%s', self.semantic_data['place']['room'])
    return 0
