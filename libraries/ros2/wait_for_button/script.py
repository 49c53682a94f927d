from rafcon import ros


def execute(self, inputs, outputs, gvm):
    released = []

    def pressed(message):
        down = inputs["button"] < len(message.buttons) and message.buttons[inputs["button"]] != 0
        if not down:
            released.append(True)
        return down and released

    try:
        ros.wait_for(inputs["topic"], "sensor_msgs/Joy", pressed, inputs["timeout"] or None)
    except ros.TimedOut:
        return "timed_out"
    return "pressed"
