"""The bridge: offers the machines of a server to ROS 2. ``rafcon serve --ros`` starts it in a process of its own.

It is a client of the server's interface like any other (docs/api.md), named ``ros``, with the right of an operator.
docs/guide/ros.md says what it offers.
"""

import json
import sys

__all__ = ["main"]


def main():
    """Reads its settings, one line of JSON, from the standard input, and serves until that ends; returns the exit code."""
    from rafcon.ros import RosError
    from rafcon.ros.bridge._serving import Bridge

    told = json.loads(sys.stdin.readline())
    try:
        bridge = Bridge(told)
    except RosError as error:
        print(f"the bridge to ROS cannot begin: {error}", flush=True)
        return 1
    return bridge.run(sys.stdin)
