from rafcon import ros


def execute(self, inputs, outputs, gvm):
    outputs["why"] = ""
    try:
        response = ros.call(inputs["service"], inputs["request"], inputs["type"] or None, inputs["timeout"] or None)
    except ros.NoServer as error:
        outputs["why"] = str(error)
        return "no_server"
    except ros.TimedOut as error:
        outputs["why"] = str(error)
        return "timed_out"
    outputs["response"] = response.as_dict()
    if not response.get("success", True):
        outputs["why"] = str(response.get("message", ""))
        return "failed"
    return "success"
