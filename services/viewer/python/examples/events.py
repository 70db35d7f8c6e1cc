"""Writes down where the robot was and what its camera saw, once per picture, three times."""
import itertools
import sys

from luminav import Robot

robot = Robot(*sys.argv[1:])
for event in itertools.islice(robot.events("picture"), 3):
    seen = event.data["seen"]
    count = len(seen["detections"]) if seen else 0
    pose = robot.pose
    print(f"picture {event.data['sequence']}: {count} fixtures, from ({pose.x:.2f}, {pose.y:.2f}), {len(robot.picture())} bytes")
