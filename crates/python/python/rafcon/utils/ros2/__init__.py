"""ROS 2 from scripts: a node that all states share, and handles that heed preemption.

A first state makes the node and puts it, by reference, into the global variable ``rafcon_ros_node``; it also makes the
dictionaries ``ros_publishers`` and ``ros_clients``, in which the handles keep what they made for the next run.
Everything needs ROS 2's own packages (``rclpy``).
"""

from rafcon._lazy import submodules

__getattr__ = submodules(__name__)
