def execute(self, inputs, outputs, gvm):
    inputs['items'].append('changed')
    return 0
