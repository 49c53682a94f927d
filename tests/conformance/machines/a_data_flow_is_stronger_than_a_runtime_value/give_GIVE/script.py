def execute(self, inputs, outputs, gvm):
    outputs['value'] = 50
    return 0
