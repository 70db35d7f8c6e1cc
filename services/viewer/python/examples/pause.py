"""Lets the robot wait on its way, as for somebody who wants to pass."""
import sys
import time

from luminav import NavigationState, Robot

robot = Robot(*sys.argv[1:])
task = robot.go((5.4, 5.6))
time.sleep(2)
robot.pause().wait()
feedback = task.feedback()
print("paused:", feedback is not None and feedback.state is NavigationState.PAUSED)
robot.resume().wait()
result = task.wait(timeout=60)
print(result.ending)
sys.exit(0 if result else 1)
