from rafcon import ros


def execute(self, inputs, outputs, gvm):
    code = compile(inputs["condition"], "<condition>", "eval") if inputs["condition"] else None
    fits = None if code is None else lambda message: eval(code, {"message": message, "inputs": inputs, "gvm": gvm})
    try:
        message = ros.wait_for(inputs["topic"], inputs["type"] or None, fits, inputs["timeout"] or None)
    except ros.TimedOut as error:
        self.logger.warning("%s", error)
        return "timed_out"
    outputs["message"] = message.as_dict()
    return "success"
