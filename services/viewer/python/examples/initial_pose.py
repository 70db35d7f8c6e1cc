"""Tells the robot where it is. The ceiling confirms that, or not, while it drives."""
import sys

from luminav import Robot

robot = Robot(*sys.argv[1:])
robot.set_initial_pose(x=5.4, y=5.6, theta=0.3).wait()
task = robot.go((6.4, 6.0))
pose = robot.wait_until_known(timeout=60)
print(f"at ({pose.x:.2f}, {pose.y:.2f}), heading {pose.theta:.2f} rad")
print(task.wait().ending)
