"""The map of what the robot knows of its surroundings."""
from __future__ import annotations

import base64
import enum
import math
import zlib
from typing import Any, Mapping, Optional, Sequence, Tuple

TILE = 64  # [cells] side of a tile
OCCUPIED_EVIDENCE = 16  # log-odds 0.8 x 20, as the planner: more says that something stands there


class Cell(enum.Enum):
    UNKNOWN = 205
    FREE = 254
    OCCUPIED = 0


class Map:
    """Cells that the building's map or the sonars say something of. A new one is read by `Robot.map`."""

    def __init__(self, tiles: Sequence[Mapping[str, Any]]) -> None:
        self.resolution = 0.0  # [m] side of a cell
        self.origin: Tuple[float, float] = (0.0, 0.0)  # [m] lower left corner
        self.columns = 0
        self.rows = 0
        self._tiles = {}
        for tile in tiles:
            self.resolution, self.columns, self.rows = tile["resolution"], tile["columns"], tile["rows"]
            self.origin = (tile["origin"][0], tile["origin"][1])
            self._tiles[tile["tile_column"], tile["tile_row"]] = zlib.decompress(base64.b64decode(tile["data"]))

    def at(self, x: float, y: float) -> Cell:
        """Returns what is known of a point in the building [m]."""
        if not self._tiles:
            return Cell.UNKNOWN
        return self.cell(math.floor((x - self.origin[0]) / self.resolution), math.floor((y - self.origin[1]) / self.resolution))

    def cell(self, column: int, row: int) -> Cell:
        """Returns what is known of a cell, counted from the lower left corner; UNKNOWN outside."""
        data = self._tiles.get((column // TILE, row // TILE))
        if data is None:
            return Cell.UNKNOWN
        index = row % TILE * TILE + column % TILE
        prior, evidence = data[index], data[TILE * TILE + index]
        evidence -= 256 if evidence > 127 else 0
        if prior >= 2 or evidence > OCCUPIED_EVIDENCE:  # occupied, or disputed: in doubt something stands there
            return Cell.OCCUPIED
        return Cell.FREE if prior == 1 or evidence < 0 else Cell.UNKNOWN

    def pgm(self) -> bytes:
        """Returns a picture as map_server takes it: black is occupied, white free, grey unknown; north at the top."""
        rows = (bytes(self.cell(column, row).value for column in range(self.columns)) for row in reversed(range(self.rows)))
        return f"P5\n{self.columns} {self.rows}\n255\n".encode() + b"".join(rows)
