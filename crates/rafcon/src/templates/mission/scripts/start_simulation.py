"""Puts the simulated world in place: the robot, what is hidden where, and what stands in the way."""

import random


def execute(self, inputs, outputs, gvm):
    world = random.Random(inputs["seed"])
    places = list(range(1, inputs["waypoints"] + 1))
    world.shuffle(places)
    hidden = {"battery": places[0], "mug": places[-1]}
    rocks = places[1 : 1 + len(places) // 20]
    gvm.set_variable("time_scale", inputs["time_scale"])
    gvm.set_variable("seed", inputs["seed"])
    gvm.set_variable("hidden", hidden)
    gvm.set_variable("rocks", rocks)
    gvm.set_variable("position", (0.0, 0.0))
    gvm.set_variable("battery", 100.0)
    gvm.set_variable("surveying", True)
    gvm.set_variable("found", {})
    gvm.set_variable("in the gripper", None)
    gvm.set_variable("fetched", [])
    # By reference: it grows with every waypoint, and copying it each time would take longer and longer.
    gvm.set_variable("waypoints", {}, per_reference=True)
    return "success"
