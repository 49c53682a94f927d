"""A robot with the actions of Nav2 and MoveIt, and its transforms: by ``rafcon.ros`` in a process of its own, since no package of Python has their types.

Each line on the standard input is a JSON list of a word and its arguments, each is answered by a line with JSON.
"""

import json
import pathlib
import sys
import threading

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python"))

from rafcon import ros

#: What is asked of the robot by the tree of Nav2, or the group of MoveIt.
WAIT, ABORT = "wait", "abort"
PLANNING_FAILED = -1


class Robot:
    """Goals by action, as they came; and those that are under way."""

    def __init__(self):
        self.changed = threading.Condition()
        self.goals = []
        self.open = 0
        ros.action_server("/navigate_to_pose", self.navigate, "nav2_msgs/NavigateToPose")
        ros.action_server("/follow_waypoints", self.follow, "nav2_msgs/FollowWaypoints")
        ros.action_server("/move_action", self.move, "moveit_msgs/MoveGroup")

    def began(self, goal, count):
        with self.changed:
            self.open += count
            if count > 0:
                self.goals.append(goal.goal.as_dict())
            self.changed.notify_all()

    def carry_out(self, goal, how, feedback, result, refused):
        """Succeeds, aborts, or waits until it is cancelled."""
        self.began(goal, 1)
        try:
            goal.feedback(feedback)
            if how == ABORT:
                raise ros.GoalAborted("as asked", refused)
            if how == WAIT:
                while not goal.wait(60):
                    pass
            return result
        finally:
            self.began(goal, -1)

    def navigate(self, goal):
        refused = {"error_code": 9, "error_msg": "no way"}
        feedback = {"distance_remaining": 1.5, "number_of_recoveries": 2, "current_pose": goal.goal.pose}
        return self.carry_out(goal, goal.goal.behavior_tree, feedback, {}, refused)

    def follow(self, goal):
        missed = [{"index": 1, "goal": goal.goal.poses[1], "error_code": 9}]
        return self.carry_out(goal, "", {"current_waypoint": 1}, {"missed_waypoints": missed}, {})

    def move(self, goal):
        names = [each.joint_name for each in goal.goal.request.goal_constraints[0].joint_constraints]
        point = {"positions": [each.position for each in goal.goal.request.goal_constraints[0].joint_constraints]}
        trajectory = {"joint_trajectory": {"joint_names": names, "points": [point]}}
        result = {"error_code": {"val": 1}, "planned_trajectory": trajectory, "planning_time": 0.25}
        refused = {"error_code": {"val": PLANNING_FAILED, "message": "no plan"}}
        return self.carry_out(goal, goal.goal.request.group_name, {"state": "PLANNING"}, result, refused)

    # ---- what it is told

    def do_goal(self, count):
        """Waits until so many goals came; the last of them."""
        with self.changed:
            self.changed.wait_for(lambda: len(self.goals) >= count, 20)
            return self.goals[-1]

    def do_open(self):
        """How many goals are under way; waits until there is none."""
        with self.changed:
            self.changed.wait_for(lambda: not self.open, 20)
            return self.open

    def do_transforms(self, parent, child, x, static):
        """Publishes a transform."""
        header = {"frame_id": parent, "stamp": ros.stamp()}
        turn = {"rotation": {"w": 1.0}, "translation": {"x": x}}
        message = {"transforms": [{"header": header, "child_frame_id": child, "transform": turn}]}
        topic, quality = ("/tf_static", "latched") if static else ("/tf", "default")
        ros.publish(topic, message, "tf2_msgs/TFMessage", quality, 20)


def main():
    robot = Robot()
    print(json.dumps("up"), flush=True)
    for line in sys.stdin:
        word, *arguments = json.loads(line)
        print(json.dumps(getattr(robot, "do_" + word)(*arguments)), flush=True)
    ros.close()


if __name__ == "__main__":
    main()
