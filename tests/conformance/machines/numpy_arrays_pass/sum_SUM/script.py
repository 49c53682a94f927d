def execute(self, inputs, outputs, gvm):
    outputs['sum'] = int(inputs['value'].sum())
    return 0
