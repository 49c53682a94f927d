"""Bridge that offers the machines of a server to ROS 2; a process of ``rafcon serve --ros``.

It is a client of the server's interface (docs/api.md), named ``ros``, with the permissions of an
operator. docs/guide/ros.md lists what it offers.
"""

import json
import sys

__all__ = ["main"]


def main():
    """Read the settings, one line of JSON, from standard input, and serve until its end.

    Returns the exit code.
    """
    from rafcon.ros import RosError
    from rafcon.ros.bridge._serving import Bridge

    told = json.loads(sys.stdin.readline())
    try:
        bridge = Bridge(told)
    except RosError as error:
        print(f"the bridge to ROS cannot begin: {error}", flush=True)
        return 1
    return bridge.run(sys.stdin)
