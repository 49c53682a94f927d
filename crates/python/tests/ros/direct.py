"""Calls a service as a script does that uses ``rclpy`` itself: a node, an executor on a thread, and calls on another.

Each line on the standard input is a JSON list of the word ``rate`` and a number of calls; each is answered by the calls a second.
"""

import json
import sys
import threading
import time

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from std_srvs.srv import SetBool


def main():
    rclpy.init()
    node = rclpy.create_node("direct")
    client = node.create_client(SetBool, sys.argv[1])
    executor = SingleThreadedExecutor()
    executor.add_node(node)

    def spin():
        try:
            executor.spin()
        except ExternalShutdownException:
            pass

    spinning = threading.Thread(target=spin, daemon=True)
    spinning.start()
    client.wait_for_service(10)
    print(json.dumps("up"), flush=True)
    for line in sys.stdin:
        _word, count = json.loads(line)
        begin_s = time.perf_counter()
        for _ in range(count):
            client.call(SetBool.Request(data=True), 10)
        print(json.dumps(count / (time.perf_counter() - begin_s)), flush=True)
    rclpy.shutdown()
    spinning.join()


if __name__ == "__main__":
    main()
