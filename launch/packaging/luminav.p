;; For ARIA: copy this file into its folder "params". ARIA reads it after the parameters of the robot's kind when a robot
;; calls itself luminav, as the simulator does. Without it ARIA takes that robot for one with a laser and looks for it long.
ConfigVersion 2.0
Section Laser parameters
LaserAutoConnect false
