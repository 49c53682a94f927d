def execute(self, inputs, outputs, gvm):
    self.logger.info('%s %s', self.get_path(), inputs['text'])
    return 0

