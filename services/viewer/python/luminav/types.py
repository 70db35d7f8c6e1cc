"""What the robot says, as values. Metres, radians counter-clockwise, seconds; poses in the building's frame."""
from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import Any, Mapping, Optional, Tuple, Union


class PoseState(enum.IntEnum):
    LOST = 0
    AMBIGUOUS = 1
    TRACKING = 2


class NavigationState(enum.IntEnum):
    IDLE = 0
    LOCALIZING = 1
    PLANNING = 2
    FOLLOWING = 3
    WAITING = 4
    ARRIVED = 5
    NO_PATH = 6
    BLOCKED = 7
    STUCK = 8
    CANCELLED = 9
    LOST = 10
    PAUSED = 11


UNDER_WAY = (NavigationState.LOCALIZING, NavigationState.PLANNING, NavigationState.FOLLOWING, NavigationState.WAITING)


@dataclass(frozen=True)
class Pose:
    """Where the robot believes it is; only a best guess unless `state` is TRACKING."""

    x: float  # [m]
    y: float  # [m]
    theta: float  # [rad] (-pi, pi]
    state: PoseState
    reason: str  # why this state

    @property
    def is_known(self) -> bool:
        return self.state is PoseState.TRACKING


@dataclass(frozen=True)
class Place:
    """A name that the building has for a goal."""

    name: str
    x: float  # [m]
    y: float  # [m]
    theta: Optional[float]  # [rad]; None: any heading will do


@dataclass(frozen=True)
class Waypoint:
    """A stop on the way."""

    x: float  # [m]
    y: float  # [m]
    theta: Optional[float] = None  # [rad]; None: any heading will do
    wait: float = 0.0  # [s] to stay there


Target = Union[str, Waypoint, Place, Tuple[float, float], Tuple[float, float, float]]
"""The name of a place, (x, y), (x, y, theta), or a Waypoint."""


def goal_pose(target: Target) -> Mapping[str, Any]:
    """Returns a target as the viewer takes it."""
    if isinstance(target, str):
        return {"place": target}
    if isinstance(target, Place):
        return {"place": target.name}
    waypoint = target if isinstance(target, Waypoint) else Waypoint(*target)
    pose = {"x": float(waypoint.x), "y": float(waypoint.y)}
    if waypoint.theta is not None:
        pose["theta"] = float(waypoint.theta)
    if waypoint.wait:
        pose["wait"] = float(waypoint.wait)
    return pose
