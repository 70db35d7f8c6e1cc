"""The robot, as a program sees it."""
from __future__ import annotations

import math
import time
from types import TracebackType
from typing import Any, Dict, Iterable, Iterator, List, Mapping, Optional, Set, Type, Union

from . import tours
from .connection import Connection, Event
from .errors import RobotError
from .grid import Map
from .jobs import Job, JobStatus, job_stop, request, statuses
from .task import PERIOD, Request, Task
from .types import UNDER_WAY, Place, Pose, PoseState, Target, goal_pose


class Robot:
    """A robot whose viewer serves at `address`.

    Nothing is kept between calls: each asks the viewer, so what a property says is a tenth of a second old at most. Methods raise
    Unreachable when the viewer does not answer within `timeout` [s], and Refused, with the reason, when it does not want to.
    """

    def __init__(self, address: str = "http://127.0.0.1:8080", *, token: Optional[str] = None, timeout: float = 5.0) -> None:
        self._connection = Connection(address, token, timeout)
        self._goals: Set[int] = set()  # ids of pauses and the like, which are about the goal before

    @property
    def state(self) -> Dict[str, Any]:
        """All that the page shows of the robot, as /api/openapi.json describes it."""
        state: Dict[str, Any] = self._connection.get("/api/state")
        return state

    @property
    def pose(self) -> Pose:
        """Where the robot believes it is. Raises RobotError while the localizer is silent."""
        told = self.state.get("pose")
        if told is None:
            raise RobotError("the localizer was not heard yet")
        return Pose(told["x"], told["y"], told["theta"], PoseState(told["state"]), told["reason"])

    @property
    def battery(self) -> float:
        """The battery's voltage [V]; 0 while it is not known."""
        return float(self.state.get("robot", {}).get("battery_voltage") or 0.0)

    @property
    def is_stopped(self) -> bool:
        """Whether a STOP is in force, by the robot's own word."""
        return bool(self.state.get("robot", {}).get("stop_engaged"))

    @property
    def places(self) -> Dict[str, Place]:
        """The places that the building has a name for."""
        told = self._connection.get("/api/places")["places"]
        return {item["name"]: Place(item["name"], item["x"], item["y"], item.get("theta")) for item in told}

    def events(self, *names: str) -> Iterator[Event]:
        """Yields the viewer's events as they come, of these names if any are given: state (10 per second), nodes and processes
        (1 per second), hypotheses, path, jobs, survey, picture and tile. Raises Unreachable when the connection ends."""
        for event in self._connection.events():
            if not names or event.name in names:
                yield event

    def wait_until_known(self, timeout: Optional[float] = None) -> Pose:
        """Returns the pose once the robot knows it. It looks for it only while it has a goal, or after `set_initial_pose`."""
        end = None if timeout is None else time.monotonic() + timeout
        while True:
            if "pose" in self.state and self.pose.is_known:
                return self.pose
            if end is not None and time.monotonic() > end:
                raise RobotError(f"not localized within {timeout:g} s")
            time.sleep(PERIOD)

    def go(self, target: Target, theta: Optional[float] = None) -> Task:
        """Sends the robot to a place, a point or a Waypoint; `theta` [rad] is the heading at a point (x, y)."""
        if theta is not None:
            if isinstance(target, tuple) and len(target) == 2:
                target = (target[0], target[1], theta)
            else:
                raise ValueError("theta belongs to a point (x, y)")
        return self.follow([target])

    def follow(self, targets: Iterable[Target], loop: bool = False, policy: str = "stop") -> Task:
        """Sends the robot to one target after another, up to 100; with `loop` round and round until it is cancelled. `policy` says
        what one that cannot be reached means for the others: stop, skip or retry."""
        body = {"action": "go", "poses": [goal_pose(target) for target in targets], "loop": loop, "policy": policy}
        return Task(self, self._connection.post("goal", body)["id"])

    def patrol(self, targets: Iterable[Target]) -> Task:
        """The same as `follow` with `loop`."""
        return self.follow(targets, loop=True)

    def pause(self) -> Request:
        """Lets the robot stand; it keeps its goal for `resume`."""
        return self._about_goal("pause")

    def resume(self) -> Request:
        return self._about_goal("resume")

    def cancel(self) -> Request:
        """Lets the robot give its goal up."""
        return self._about_goal("cancel")

    def continues(self, goal: int) -> bool:
        """Whether a goal's id is that of a pause, resume or cancel by this Robot."""
        return goal in self._goals

    @property
    def jobs(self) -> List[JobStatus]:
        """The queue of jobs: the one under way, those that wait in their order, the last ten that are over."""
        return statuses(self._connection)

    def queue(self, target: Target, priority: int = 0) -> Job:
        """Puts a drive to a target into the queue; `go` sends the robot there at once."""
        return self._add("go", [target], priority)

    def carry(self, origin: Target, destination: Target, priority: int = 0, on_timeout: str = "ask") -> Job:
        """Lets it fetch something at `origin`, where somebody confirms "loaded", and bring it to `destination`. `on_timeout` says
        what it means when nobody does: ask, give_up or go_on."""
        return self._add("carry", [origin, destination], priority, {"on_timeout": on_timeout})

    def guide(self, target: Target, priority: int = 0) -> Job:
        """Lets it lead somebody to a target, wait for him, and go back for him."""
        return self._add("guide", [target], priority)

    def tour(self, stops: Union[str, Iterable[Target]], priority: int = 0) -> Job:
        """Lets it drive from stop to stop: a stored tour by its name, or a list in which a Waypoint's wait is a pause."""
        if isinstance(stops, str):
            return self._add("tour", [], priority, {"tour": stops})
        return self._add("tour", stops, priority)

    def home(self, priority: int = 0) -> Job:
        """Lets it drive home, and see whether it charges there."""
        return self._add("home", [], priority)

    @property
    def stored_tours(self) -> Dict[str, tours.Tour]:
        """The tours of the building's jobs file, in its order."""
        return tours.read_all(self._connection)

    def store_tour(self, tour: tours.Tour, replacing: str = "", accept: bool = False) -> None:
        """Stores a new tour, or puts it in the place of one. Raises Refused with what checking finds wrong; with `accept` it is stored all
        the same. The robot knows it a second later. What the file said before is kept."""
        name = {"name": replacing} if replacing else {}
        tours.edit(self._connection, {"action": "set_tour", "tour": tour.write(), "accept": accept, **name})

    def move_tour(self, name: str, before: str = "") -> None:
        """Puts a stored tour before another one; "" = at the end."""
        tours.edit(self._connection, {"action": "move_tour", "name": name, **({"before": before} if before else {})})

    def delete_tour(self, name: str) -> None:
        tours.edit(self._connection, {"action": "remove_tour", "name": name})

    def undo_tours(self) -> None:
        """Takes the last change of the stored tours back."""
        tours.edit(self._connection, {"action": "undo"})

    def _add(self, kind: str, stops: Iterable[Target], priority: int, more: Mapping[str, Any] = {}) -> Job:
        body = {"action": "add", "kind": kind, "stops": [job_stop(stop) for stop in stops], "priority": priority, **more}
        return Job(self._connection, request(self._connection, body))

    def stop(self) -> Request:
        """Stops the robot, now, until somebody releases it. Needs no token. The viewer repeats it until driver and controller obey."""
        return Request(self, "stop", self._connection.post_stop()["id"])

    def release(self, go_on: bool = False) -> Request:
        """Ends a STOP. The robot stays where it is, a goal that was interrupted is paused first; with `go_on` it drives on at once."""
        told = self.state.get("navigation")
        if not go_on and told is not None and told["state"] in UNDER_WAY:
            self.pause().wait()
        return self._request("stop", {"engaged": False})

    def enable_motors(self, enable: bool = True) -> Request:
        """Switches the motors. Whoever switches them on sees the robot, or it may run into somebody."""
        return self._request("motors", {"enable": enable})

    def set_initial_pose(self, x: float, y: float, theta: float, sigma: float = 0.5, sigma_theta: float = math.radians(20)) -> Request:
        """Tells the localizer where the robot is, with deviations [m, rad]: a guess that it checks against the ceiling."""
        return self._request("initial_pose", {"x": x, "y": y, "theta": theta, "sigma": sigma, "sigma_theta": sigma_theta})

    def map(self) -> Map:
        """Returns the map of now."""
        return Map(self._connection.get("/api/map")["tiles"])

    def save_map(self) -> Request:
        """Lets the mapper write the map to its state folder, from where it is loaded at the next start."""
        return self._request("map", {"action": "save"})

    def clear_map(self) -> Request:
        """Lets the mapper forget what the sonars saw; the building's own map stays."""
        return self._request("map", {"action": "clear_evidence"})

    def picture(self) -> bytes:
        """Returns the newest picture of the ceiling, a JPEG file."""
        return self._connection.get_bytes("/camera.jpg")

    def steering(self) -> Steering:
        """Drives by hand: `with robot.steering() as wheel: wheel.drive(0.2, 0.0)`."""
        return Steering(self._connection)

    def restart(self, process: str) -> None:
        """Orders the deputy of a process, such as "detector", to start it again."""
        self._connection.post("process", {"name": process, "action": "restart"})

    def watch(self) -> bool:
        """Tells the robot that a person sees it and could stop it, for two seconds; returns whether this program may command.
        Not to be called where nobody looks."""
        return bool(self._connection.post("watch", {})["may_command"])

    def _request(self, name: str, body: Mapping[str, Any]) -> Request:
        return Request(self, name, self._connection.post(name, body)["id"])

    def _about_goal(self, action: str) -> Request:
        request = self._request("goal", {"action": action})
        self._goals.add(request.id)
        return request


class Steering:
    """A hand on the stick. The robot stops 0.3 s after the last command, so `drive` is to be called ten times a second."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._session = time.time_ns() // 1000
        self._sequence = 0
        self._clock = 0.0  # [s] of the viewer's host, less that of this program

    def __enter__(self) -> Steering:
        self._clock = self._connection.get("/api/state")["utime"] * 1e-6 - time.monotonic()
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        if kind is None:
            self._send(0.0, 0.0)

    def drive(self, linear: float, angular: float, seconds: float = PERIOD) -> None:
        """Drives for so long at `linear` [m/s] forward and `angular` [rad/s] counter-clockwise, and returns."""
        end = time.monotonic() + seconds
        while True:
            self._send(linear, angular)
            left = end - time.monotonic()
            time.sleep(max(0.0, min(PERIOD, left)))
            if left <= PERIOD:
                return

    def _send(self, linear: float, angular: float) -> None:
        self._sequence += 1
        seen = round((time.monotonic() + self._clock) * 1e6)
        self._connection.post("steering", {"session": self._session, "sequence": self._sequence, "linear": linear,
                                           "angular": angular, "seen": seen})
