def execute(self, inputs, outputs, gvm):
    self.logger.info('%s %s', self.name, self.state_id)
    self.logger.info('%s %s', self.get_path(), self.get_path(by_name=True))
    self.logger.info('%s %s', self.parent.name, self.is_root_state)
    self.logger.info('%s', sorted(outcome.name for outcome in self.outcomes.values()))
    self.logger.info('%s %s', self.preempted, self.paused)
    self.logger.info('%s', self.get_state_machine().root_state.name)
    self.logger.info('%s', sorted(self.parent.states))
    return 0

