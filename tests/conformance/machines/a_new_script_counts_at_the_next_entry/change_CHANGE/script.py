def execute(self, inputs, outputs, gvm):
    other = self.parent.states["OTHER"]
    head = "def execute(self, inputs, outputs, gvm):"
    other.script_text = head + "\n    self.logger.info('changed')\n    return 0\n"
    return 0
