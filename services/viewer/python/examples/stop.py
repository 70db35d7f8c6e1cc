"""Stops the robot on its way, lets it go again, and has it finish its drive."""
import sys
import time

from luminav import Robot

robot = Robot(*sys.argv[1:])
task = robot.go((7.2, 6.4))
time.sleep(2)
robot.stop().wait()
print("stopped:", robot.is_stopped)
robot.release().wait()
robot.resume().wait()  # without it the robot would stay, its goal paused
result = task.wait(timeout=60)
print(result.ending, result.cause)
sys.exit(0 if result else 1)
