def execute(self, inputs, outputs, gvm):
    outputs['doubled'] = inputs['number'] * 2
    return 'success' if outputs['doubled'] < 100 else 'too big'

