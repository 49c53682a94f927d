from rafcon import ros


def execute(self, inputs, outputs, gvm):
    ros.publish(inputs["topic"], inputs["message"], inputs["type"] or None, inputs["qos"] or None)
    return "success"
