def execute(self, inputs, outputs, gvm):
    outputs['sum'] = inputs['number'] + 1
    return 0
