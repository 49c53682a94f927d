def execute(self, inputs, outputs, gvm):
    entries = self.persistent_variables.get('entries', 0) + 1
    self.persistent_variables['entries'] = entries
    self.logger.info('%d', entries)
    return 'again' if entries < 3 else 'success'

