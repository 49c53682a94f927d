def execute(self, inputs, outputs, gvm):
    self.logger.info('%s', inputs['value'])
    self.logger.info('%s', self.get_outcome_for_state_name('left').name)
    self.logger.info('%s', self.get_outcome_for_state_id('RIGHT').name)
    self.logger.info('%r', self.get_errors_for_state_name('right'))
    self.logger.info('%r', self.get_errors_for_state_name('left'))
    outputs['value'] = inputs['value'] + 1
    return 'mixed'

