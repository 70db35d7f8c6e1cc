"""Drives a Luminav robot from Python, over its viewer's HTTP interface. Needs the standard library only.

    from luminav import Robot
    result = Robot("http://robot:8080").go("lift").wait()
    print(result.ending, result.cause)
"""
from .connection import Event
from .errors import Refused, RobotError, Unreachable
from .grid import Cell, Map
from .jobs import Job, JobState, JobStatus
from .robot import Robot, Steering
from .task import Feedback, Outcome, Request, Task, TaskResult
from .tours import Tour, TourStop
from .types import NavigationState, Place, Pose, PoseState, Target, Waypoint

__version__ = "0.1.0"
__all__ = ["Cell", "Event", "Feedback", "Job", "JobState", "JobStatus", "Map", "NavigationState", "Outcome", "Place", "Pose", "PoseState", "Refused", "Request",
           "Robot", "RobotError", "Steering", "Target", "Task", "TaskResult", "Tour", "TourStop", "Unreachable", "Waypoint"]
