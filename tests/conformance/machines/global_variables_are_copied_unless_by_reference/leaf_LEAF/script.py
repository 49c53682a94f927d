def execute(self, inputs, outputs, gvm):
    copied, shared = [1], [1]
    gvm.set_variable('copied', copied)
    gvm.set_variable('shared', shared, per_reference=True)
    copied.append(2)
    shared.append(2)
    gvm.get_variable('copied').append(3)
    gvm.get_variable('shared').append(3)
    self.logger.info('%s %s', gvm.variable_exist('copied'), gvm.get_variable('none', default='default'))
    return 0

