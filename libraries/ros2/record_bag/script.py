import shutil
import signal
import subprocess

#: The recorder closes its files within this time (s).
END_S = 10


def execute(self, inputs, outputs, gvm):
    outputs["why"] = ""
    if shutil.which("ros2") is None:
        outputs["why"] = "there is no command ros2 on the path: source a ROS 2 workspace with rosbag2 before the start"
        return "no_recorder"
    words = ["ros2", "bag", "record", *(["-o", inputs["bag"]] if inputs["bag"] else []), *(inputs["topics"] or ["--all"])]
    recorder = subprocess.Popen(words, stdin=subprocess.DEVNULL, start_new_session=True)
    try:
        over = inputs["duration"] and not self.preemptive_wait(inputs["duration"])
        while not over and recorder.poll() is None and not self.preempted:
            self.preemptive_wait(0.2)
        early = recorder.poll()
    finally:
        if recorder.poll() is None:
            recorder.send_signal(signal.SIGINT)
        try:
            recorder.wait(END_S)
        except subprocess.TimeoutExpired:
            recorder.kill()
            recorder.wait()
    if early is not None:
        outputs["why"] = f"ros2 bag record ended by itself with the code {early}; the log has what it said"
        return "failed"
    return "preempted" if self.preempted else "success"
