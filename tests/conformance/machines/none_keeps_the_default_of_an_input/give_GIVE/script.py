def execute(self, inputs, outputs, gvm):
    outputs['value'] = None
    return 0
