def execute(self, inputs, outputs, gvm):
    outputs['value'] = 'late'
    return 0
