def execute(self, inputs, outputs, gvm):
    gvm.set_variable('guarded', 1)
    key = gvm.lock_variable('guarded')
    gvm.set_locked_variable('guarded', key, 2)
    self.logger.info('%s', gvm.get_locked_variable('guarded', key))
    try:
        gvm.set_variable('guarded', 3, access_key='wrong')
    except RuntimeError as error:
        self.logger.info('%s', type(error).__name__)
    self.logger.info('%s %s', gvm.unlock_variable('guarded', key), gvm.is_locked('guarded'))
    return 0

