def execute(self, inputs, outputs, gvm):
    ours = self.parent
    give, take = ours.states["GIVE"], ours.states["TAKE"]
    out = give.add_output_data_port("word", str, "given")
    port = take.add_input_data_port("word", str, "default")
    ours.add_data_flow("GIVE", out, "TAKE", port)
    return 0
