"""Nav2, MoveIt, transforms and the time of a simulation: robots that others are.

Their types are in ``rafcon-ros``; for ``rclpy`` no package of Python has them, so these tests are for the native back end. Run with
``RAFCON_ROS_BACKEND=native``.
"""

import os
import sys
import unittest

import peers
import test_library

from rafcon import ros

NATIVE = os.environ.get("RAFCON_ROS_BACKEND") == "native"


class Robot(peers.Peer):
    """The program ``robot.py``, in this interpreter."""

    def __init__(self):
        peers.Peer.__init__(self, "robot.py", python=sys.executable)


@unittest.skipUnless(NATIVE, "no package of Python has these types")
class WithRobot(test_library.WithLibraries):
    @classmethod
    def setUpClass(cls):
        cls.robot = Robot()
        cls.addClassCleanup(cls.robot.close)
        cls.addClassCleanup(ros.close)

    def outputs(self, result):
        return eval(result.logged("stdout")[-1], {"array": lambda _code, values: values})  # noqa: S307, what the test itself printed


class Navigation(WithRobot):
    def test_a_robot_drives_to_a_pose(self):
        result = self.start("navigate_to_pose", x=2.0, y=1.0).finish()
        self.assertEqual((result.outcome, self.outputs(result)), ("succeeded", {"distance": 1.5, "why": ""}), result.logged())
        pose = self.robot.goal(1)["pose"]
        self.assertEqual((pose["header"]["frame_id"], pose["pose"]["position"]), ("map", {"x": 2.0, "y": 1.0, "z": 0.0}))

    def test_a_robot_that_finds_no_way_says_why(self):
        result = self.start("navigate_to_pose", behavior_tree="abort").finish()
        self.assertEqual((result.outcome, self.outputs(result)["why"]), ("aborted", "no way"), result.logged())

    def test_a_robot_that_is_stopped_drives_no_more(self):
        runner = self.start("navigate_to_pose", behavior_tree="wait", x=77.0)
        runner.said("/navigate_to_pose: ")
        runner.command("stop")
        self.assertEqual(runner.finish().outcome, "preempted")
        self.assertEqual(self.robot.open(), 0)

    def test_waypoints_that_were_missed_are_told(self):
        poses = [{"header": {"frame_id": "map"}, "pose": {"position": {"x": float(number)}}} for number in range(3)]
        ended = ros.action("/follow_waypoints", {"poses": poses}, "nav2_msgs/FollowWaypoints", find=20)
        self.assertEqual((ended.outcome, ended.feedback.current_waypoint), ("succeeded", 1))
        self.assertEqual([(each.index, each.goal.pose.position.x, each.error_code) for each in ended.result.missed_waypoints], [(1, 1.0, 9)])


class Moving(WithRobot):
    def test_a_group_moves(self):
        result = self.start("move_group", group="arm", joints={"elbow": 0.5, "wrist": -0.25}).finish()
        self.assertEqual((result.outcome, self.outputs(result)), ("succeeded", {"error_code": 1, "why": ""}), result.logged())

    def test_the_trajectory_comes_back(self):
        joints = [{"joint_name": "elbow", "position": 0.5}]
        goal = {"request": {"group_name": "arm", "goal_constraints": [{"joint_constraints": joints}]}}
        ended = ros.action("/move_action", goal, "moveit_msgs/MoveGroup", find=20)
        trajectory = ended.result.planned_trajectory.joint_trajectory
        self.assertEqual((list(trajectory.joint_names), list(trajectory.points[0].positions)), (["elbow"], [0.5]))
        self.assertEqual((ended.result.planning_time, ended.result.error_code.SUCCESS), (0.25, 1))

    def test_a_plan_that_fails_says_why(self):
        result = self.start("move_group", group="abort", joints={"elbow": 0.5}).finish()
        self.assertEqual(result.outcome, "aborted", result.logged())
        self.assertEqual(self.outputs(result), {"error_code": -1, "why": "MoveIt gives the error code -1"})

    def test_a_group_that_is_stopped_moves_no_more(self):
        runner = self.start("move_group", group="wait", joints={"elbow": 0.5})
        runner.said("/move_action: ")
        runner.command("stop")
        self.assertEqual(runner.finish().outcome, "preempted")
        self.assertEqual(self.robot.open(), 0)


class Transforms(WithRobot):
    def test_frames_of_others_are_looked_up(self):
        found = self.later(ros.transform, "map", "camera", None, 60)
        self.robot.transforms("base", "camera", 0.25, True)
        self.robot.transforms("map", "base", 2.0, False)
        self.assertEqual(found().translation, (2.25, 0.0, 0.0))

    def test_a_state_looks_them_up(self):
        self.robot.transforms("base", "lamp", 0.5, True)
        result = self.start("look_up_transform", target="base", source="lamp", timeout=20.0).finish()
        self.assertEqual((result.outcome, self.outputs(result)["translation"]), ("success", (0.5, 0.0, 0.0)), result.logged())

    def test_a_frame_that_nobody_has_is_missing(self):
        with self.assertRaisesRegex(ros.TimedOut, "no transform from map to nowhere within 0.1 s: there is no frame"):
            ros.transform("map", "nowhere", timeout=0.1)


if __name__ == "__main__":
    unittest.main()
