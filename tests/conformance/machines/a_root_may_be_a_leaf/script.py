def execute(self, inputs, outputs, gvm):
    outputs['value'] = 'alone'
    return 'other'
