def execute(self, inputs, outputs, gvm):
    outputs['value'] = 41
    return 0
