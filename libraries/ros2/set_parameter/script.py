from rafcon import ros


def execute(self, inputs, outputs, gvm):
    outputs["why"] = ""
    try:
        outputs["before"] = ros.param_get(inputs["node"], inputs["name"])
        ros.param_set(inputs["node"], inputs["name"], inputs["value"])
    except ros.ParameterError as error:
        outputs["why"] = str(error)
        return "refused"
    except (ros.NoServer, ros.TimedOut) as error:
        outputs["why"] = str(error)
        return "no_server"
    return "success"
