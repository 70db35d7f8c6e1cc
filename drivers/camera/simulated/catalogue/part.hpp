#pragma once

namespace luminav::simulated {

/// One simple shape of a thing on the ceiling, in the thing's own frame: x along its long side, y across. A thing is a
/// list of them, each painted over those before. Brightness as in CeilingLight: 1 = a tile in a fully lit room.
struct Part {
  bool round = false;         // its ends are half discs: a capsule, or a disc where both halves are equal
  double x = 0.0;             // [m] middle
  double y = 0.0;             // [m]
  double half_length = 0.0;   // [m] along x, of a capsule with its ends
  double half_width = 0.0;    // [m] along y
  double reflectance = 1.0;   // of the light that falls on the ceiling there
  double emission = 0.0;      // its own light in this state of the lamp
  double sky = 0.0;           // its own light by full daylight
  double glow = 0.0;          // bloom and halo in the picture around it; 1 = as strong as a panel of full light
  double softness = 0.0;      // [m] over which its edges fade besides the picture's own sharpness
  double rib_pitch = 0.0;     // [m] of slats, blades or rungs on it; 0 = none
  double rib_depth = 0.0;     // 0..1 share that is dark between two of them
  bool ribs_follow_x = true;  // they lie across x, one behind the other along it; else the other way round
};

}  // namespace luminav::simulated
