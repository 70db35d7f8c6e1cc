"""Goes to and fro between two points until it has been at each, then gives the patrol up."""
import sys

from luminav import Outcome, Robot

robot = Robot(*sys.argv[1:])
task = robot.patrol([(6.4, 6.0), (5.4, 5.6)])
seen = set()
for event in robot.events("state"):
    feedback = task.feedback()
    if feedback:
        seen.add(feedback.stop)
        if len(seen) == 2 and feedback.stop == 0:
            break
task.cancel()
result = task.wait(timeout=10)
print("patrol:", result.ending)
sys.exit(0 if result.outcome is Outcome.CANCELED else 1)
