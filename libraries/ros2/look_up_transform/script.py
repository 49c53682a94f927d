from rafcon import ros


def execute(self, inputs, outputs, gvm):
    outputs["why"] = ""
    try:
        found = ros.transform(inputs["target"], inputs["source"], timeout=inputs["timeout"])
    except ros.TimedOut as error:
        outputs["why"] = str(error)
        return "timed_out"
    outputs["translation"], outputs["rotation"], outputs["yaw"] = found.translation, found.rotation, found.yaw()
    return "success"
