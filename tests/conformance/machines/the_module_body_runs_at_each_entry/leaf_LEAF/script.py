count = 0

def execute(self, inputs, outputs, gvm):
    global count
    count += 1
    entries = gvm.get_variable('entries', default=0) + 1
    gvm.set_variable('entries', entries)
    self.logger.info('%d', count)
    return 'again' if entries < 3 else 'success'

