def execute(self, inputs, outputs, gvm):
    outputs['count'] = inputs['count'] + 1
    return 'again' if outputs['count'] < 10 else 'enough'

