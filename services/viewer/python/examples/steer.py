"""Turns the robot to the left by hand for a second, then to the right."""
import sys

from luminav import Robot

robot = Robot(*sys.argv[1:])
before = robot.pose.theta
with robot.steering() as wheel:
    wheel.drive(0.0, 0.4, seconds=1.0)
    turned = robot.pose.theta - before
    wheel.drive(0.0, -0.4, seconds=1.0)
print(f"turned by {turned:.2f} rad and back")
