"""Says where the robot is, which place is nearest, and how full its battery is."""
import math
import sys

from luminav import Robot

robot = Robot(*sys.argv[1:])
pose = robot.pose
if pose.is_known:
    near = min(robot.places.values(), key=lambda place: math.hypot(place.x - pose.x, place.y - pose.y))
    print(f"at ({pose.x:.2f}, {pose.y:.2f}), nearest is {near.name}")
else:
    print(f"does not know where it is: {pose.reason}")
print(f"battery {robot.battery:.1f} V")
