def execute(self, inputs, outputs, gvm):
    outputs['value'] = 'early'
    return 0
