"""Jobs: what the robot does one after another, with people who load, answer and follow."""
from __future__ import annotations

import enum
import time
from dataclasses import dataclass
from typing import Any, List, Mapping, Optional, Tuple

from .connection import Connection
from .errors import Refused, RobotError
from .task import PATIENCE
from .types import Target, goal_pose

PERIOD = 0.2  # [s] between two looks


class JobState(enum.Enum):
    QUEUED = "queued"
    DRIVING = "driving"
    AT_STOP = "at_stop"
    ASKING = "asking"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"

    @property
    def is_over(self) -> bool:
        return self in (JobState.DONE, JobState.FAILED, JobState.CANCELLED)


@dataclass(frozen=True)
class JobStatus:
    """How a job gets on."""

    id: int
    kind: str  # go, carry, tour, home or guide
    state: JobState
    position: int  # in the queue: 0 = under way, 1 = the next; -1 = over
    sentence: str  # what goes on, or how it ended
    stops: Tuple[str, ...]
    stop: int  # which of them
    waits_for: str  # word to be confirmed, such as "loaded"; "" = none
    question: str  # "" = none
    answers: Tuple[str, ...]

    @staticmethod
    def read(told: Mapping[str, Any]) -> JobStatus:
        return JobStatus(told["id"], told["kind"], JobState(told["state"]), told["position"], told["sentence"], tuple(told["stops"]),
                         told["stop"], told["waits_for"], told["question"], tuple(told["answers"]))


def job_stop(target: Target) -> Mapping[str, Any]:
    """Returns a target as the viewer takes it for a job; a Waypoint's wait is a pause there."""
    stop = dict(goal_pose(target))
    if "wait" in stop:
        stop["pause"] = stop.pop("wait")
    return stop


def statuses(connection: Connection) -> List[JobStatus]:
    return [JobStatus.read(told) for told in connection.get("/api/jobs")["jobs"]]


def request(connection: Connection, body: Mapping[str, Any]) -> int:
    """Sends a request and returns its id once the job service has acted on it. Raises Refused with what it objects to."""
    identifier: int = connection.post("jobs", body)["id"]
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        try:
            echoes = connection.get("/api/jobs")["requests"]
        except Refused as error:
            if error.status != 404:
                raise
            echoes = []  # no job service has spoken yet
        for echo in echoes:
            if echo["id"] == identifier:
                if echo["objection"]:
                    raise Refused(echo["objection"])
                return identifier
        time.sleep(PERIOD)
    raise RobotError("no job service takes up the request")


class Job:
    """A job of the robot's queue."""

    def __init__(self, connection: Connection, identifier: int) -> None:
        self._connection = connection
        self.id = identifier

    @property
    def status(self) -> JobStatus:
        """How it gets on. Raises RobotError when it is forgotten: the last ten that are over are remembered."""
        for status in statuses(self._connection):
            if status.id == self.id:
                return status
        raise RobotError(f"job {self.id} is forgotten")

    def wait(self, timeout: Optional[float] = None) -> JobStatus:
        """Returns how it ended. Raises RobotError when that takes longer than `timeout` [s]; the job goes on then."""
        return self._wait(lambda status: status.state.is_over, timeout)

    def wait_for_people(self, timeout: Optional[float] = None) -> JobStatus:
        """Returns when it is over, waits for a word or asks a question."""
        return self._wait(lambda status: bool(status.state.is_over or status.waits_for or status.question), timeout)

    def confirm(self, word: str = "") -> None:
        """Says "loaded" or "unloaded" to one that carries, "here" or "wait" to one that guides; "" = what it waits for."""
        self._say("confirm", word)

    def answer(self, word: str) -> None:
        """Answers its question with one of `status.answers`."""
        self._say("answer", word)

    def cancel(self) -> None:
        self._say("cancel", "")

    def _say(self, action: str, word: str) -> None:
        request(self._connection, {"action": action, "job": self.id, "word": word})

    def _wait(self, is_enough: Any, timeout: Optional[float]) -> JobStatus:
        end = None if timeout is None else time.monotonic() + timeout
        while True:
            status = self.status
            if is_enough(status):
                return status
            if end is not None and time.monotonic() > end:
                raise RobotError(f"still under way after {timeout:g} s: {status.sentence}")
            time.sleep(PERIOD)
