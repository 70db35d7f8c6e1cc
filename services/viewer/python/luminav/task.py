"""What becomes of a request, and of a drive."""
from __future__ import annotations

import enum
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Mapping, Optional

from .errors import Refused, RobotError
from .types import NavigationState

if TYPE_CHECKING:
    from .robot import Robot

PERIOD = 0.1  # [s] between two looks; the viewer renews its state ten times a second
PATIENCE = 12.0  # [s] a request is repeated for 10 s


class Outcome(enum.Enum):
    """How a drive ended; the names are those of nav2_simple_commander."""

    SUCCEEDED = "succeeded"
    CANCELED = "canceled"
    FAILED = "failed"


@dataclass(frozen=True)
class TaskResult:
    """How a drive ended and why. True when it succeeded."""

    outcome: Outcome
    ending: str  # arrived, no path, blocked, stuck, cancelled, lost, replaced, or nobody answers
    cause: str  # the planner's sentence

    def __bool__(self) -> bool:
        return self.outcome is Outcome.SUCCEEDED


@dataclass(frozen=True)
class Feedback:
    """How a drive is getting on."""

    state: NavigationState
    cause: str  # one plain sentence, or ""
    distance_left: float  # [m] along the path to the next stop
    stop: int  # which of the stops it is driving to, from 0
    stops: int


_ENDINGS = {
    NavigationState.ARRIVED: (Outcome.SUCCEEDED, "arrived"),
    NavigationState.NO_PATH: (Outcome.FAILED, "no path"),
    NavigationState.BLOCKED: (Outcome.FAILED, "blocked"),
    NavigationState.STUCK: (Outcome.FAILED, "stuck"),
    NavigationState.CANCELLED: (Outcome.CANCELED, "cancelled"),
    NavigationState.LOST: (Outcome.FAILED, "lost"),
}


class Request:
    """Something the robot was asked for. It is repeated until the robot obeys; `wait` waits for that."""

    def __init__(self, robot: Robot, kind: str, identifier: int) -> None:
        self._robot = robot
        self.kind = kind
        self.id = identifier

    def wait(self, timeout: float = PATIENCE) -> None:
        """Returns when it was obeyed. Raises Refused with the reason when it was not, and RobotError after `timeout` [s]."""
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            told = self._told()
            if told is not None and told["fate"] != "waiting":
                if told["fate"] == "unanswered" or told["objection"]:
                    raise Refused(told["objection"] or f"nobody obeyed the request ({self.kind})")
                return
            time.sleep(PERIOD)
        raise RobotError(f"not obeyed within {timeout:g} s ({self.kind})")

    def _told(self) -> Optional[Mapping[str, Any]]:
        told: Mapping[str, Any]
        for told in self._robot.state["requests"]:
            if told["kind"] == self.kind and told["id"] >= self.id:
                if told["id"] != self.id:
                    raise Refused(f"another request took its place ({self.kind})")
                return told
        return None  # the state is a tenth of a second old at most


class Task:
    """A drive that goes on while the program does."""

    def __init__(self, robot: Robot, identifier: int) -> None:
        self._robot = robot
        self.id = identifier
        self._is_taken_up = False
        self._target: Any = None
        self._result: Optional[TaskResult] = None

    def wait(self, timeout: Optional[float] = None) -> TaskResult:
        """Returns how it ended. Raises RobotError when that takes longer than `timeout` [s]; the robot drives on then."""
        end = None if timeout is None else time.monotonic() + timeout
        while not self.is_complete():
            if end is not None and time.monotonic() > end:
                raise RobotError(f"still under way after {timeout:g} s")
            time.sleep(PERIOD)
        return self.result()

    def is_complete(self) -> bool:
        if self._result is None:
            self._look()
        return self._result is not None

    def result(self) -> TaskResult:
        """Returns how it ended; raises RobotError while it goes on."""
        if self._result is None:
            raise RobotError("still under way")
        return self._result

    def feedback(self) -> Optional[Feedback]:
        """Returns how it gets on; None as long as the planner has not taken it up."""
        told = self._robot.state.get("navigation")
        if told is None or told["goal_id"] < self.id:
            return None
        return Feedback(NavigationState(told["state"]), told["cause"], told["distance_left"], told["pose_index"], told["pose_count"])

    def cancel(self) -> None:
        """Asks the planner to give it up; `wait` tells when it has."""
        self._robot.cancel()

    def _look(self) -> None:
        state = self._robot.state
        told = state.get("navigation")
        if told is None or told["goal_id"] < self.id:
            for request in state["requests"]:
                if request["kind"] == "goal" and request["id"] == self.id and request["fate"] == "unanswered":
                    self._result = TaskResult(Outcome.FAILED, "nobody answers", "no planner took up the goal within 10 s")
            return
        ending = _ENDINGS.get(NavigationState(told["state"]))
        if not self._is_ours(told):
            self._result = TaskResult(Outcome.CANCELED, "replaced", f"goal {told['goal_id']} took its place")
        elif ending is not None:
            self._result = TaskResult(*ending, told["cause"])
        self._target = told.get("target", self._target)

    def _is_ours(self, told: Mapping[str, Any]) -> bool:
        """Pausing, resuming and cancelling have ids of their own: the goal is the same while its target is."""
        if told["goal_id"] == self.id:
            self._is_taken_up = True
            return True
        is_same = (told["state"] == NavigationState.CANCELLED or self._robot.continues(told["goal_id"])
                   or (self._is_taken_up and told.get("target") == self._target))
        if is_same:
            self.id = told["goal_id"]
        return is_same
