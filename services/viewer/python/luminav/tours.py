"""The stored tours of a building, which the robot drives when somebody asks for one or its time has come."""
from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any, Dict, Mapping, Optional, Tuple

from .connection import Connection
from .errors import Refused, RobotError

PERIOD = 0.1     # [s] between two looks
PATIENCE = 20.0  # [s] checking a large building takes seconds
DAYS = ("Mo", "Tu", "We", "Th", "Fr", "Sa", "Su")


@dataclass(frozen=True)
class TourStop:
    place: str
    pause: float = 0.0  # [s] to stay there
    text: str = ""  # for people there
    photo: bool = False  # the camera's picture there is kept

    def write(self) -> Mapping[str, Any]:
        return {"place": self.place, "pause": self.pause, "text": self.text, "photo": self.photo}


@dataclass(frozen=True)
class Tour:
    name: str
    stops: Tuple[TourStop, ...]
    at: Optional[str] = None  # time of day at which it starts by itself, as "09:30"
    days: Tuple[str, ...] = DAYS  # on which it does

    @staticmethod
    def read(told: Mapping[str, Any]) -> Tour:
        stops = tuple(TourStop(stop["place"], stop.get("pause", 0.0), stop.get("text", ""), stop.get("photo", False)) for stop in told["stops"])
        return Tour(told["name"], stops, told.get("at"), tuple(told.get("days", DAYS)))

    def write(self) -> Mapping[str, Any]:
        times = {} if self.at is None else {"at": self.at}
        return {"name": self.name, "stops": [stop.write() for stop in self.stops], "days": list(self.days), **times}


def read_all(connection: Connection) -> Dict[str, Tour]:
    return {told["name"]: Tour.read(told) for told in connection.get("/api/tours")["tours"]}


def edit(connection: Connection, order: Mapping[str, Any]) -> None:
    """Has an order carried out on the tours as they are now. Raises Refused with why it was not, also with what checking finds."""
    version = connection.get("/api/tours")["version"]
    identifier: int = connection.post("tours", {"version": version, **order})["id"]
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        for outcome in connection.get("/api/tours")["orders"]:
            if outcome["id"] == identifier and outcome["fate"] == "done":
                return
            if outcome["id"] == identifier and outcome["fate"] != "waiting":
                raise Refused(outcome["said"] or "; ".join(outcome["found"]))
        time.sleep(PERIOD)
    raise RobotError(f"the viewer has not carried it out within {PATIENCE:g} s")
