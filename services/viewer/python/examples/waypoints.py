"""Drives past two points and tells meanwhile how it gets on."""
import sys
import time

from luminav import Robot, TaskResult, Waypoint

robot = Robot(*sys.argv[1:])
task = robot.follow([Waypoint(4.0, 6.0, wait=1.0), Waypoint(5.4, 5.6, theta=0.3)])
while not task.is_complete():
    feedback = task.feedback()
    if feedback:
        print(f"stop {feedback.stop + 1} of {feedback.stops}: {feedback.distance_left:.1f} m left {feedback.cause}")
    time.sleep(1)
result: TaskResult = task.result()
print(result.ending)
sys.exit(0 if result else 1)
