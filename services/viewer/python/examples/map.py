"""Has the map saved, and draws it: writes map.pgm, which image viewers and map_server read."""
import pathlib
import sys

from luminav import Robot

robot = Robot(*sys.argv[1:])
robot.save_map().wait()
grid = robot.map()
pathlib.Path("map.pgm").write_bytes(grid.pgm())
pose = robot.pose
print(f"{grid.columns} x {grid.rows} cells of {grid.resolution} m; where the robot stands it is {grid.at(pose.x, pose.y).name}")
