"""Drives to a place and says how that ended."""
import sys

from luminav import Robot

robot = Robot(*sys.argv[1:])
result = robot.go("lab-door").wait()
print(result.ending, result.cause)
sys.exit(0 if result else 1)
