#pragma once

#include <string>
#include <vector>

namespace luminav {

/// The detector under one kind of light, or below one kind of luminaire, on rendered pictures.
struct DetectorCondition {
  std::string name;
  int frames = 0;
  double precision = 1.0;
  double recall = 0.0;
  double plain = 1.0;                 // share of the fixtures whose outline a person sees in the picture
  double plain_recall = 1.0;          // over these
  double false_per_100_frames = 0.0;  // fixtures reported where there is none, or too far off
  double centre_rms_px = 0.0;
  double orientation_rms_deg = 0.0;
  double milliseconds = 0.0;  // per frame
};

/// Measures the lighting matrix on the ceilings of laboratory and office, lamps and mounting drawn anew for each world;
/// the last entry, "matrix", is over all frames. `mode` "paper", else modern. Says on stderr how far it is.
std::vector<DetectorCondition> measure_detector(const std::string& mode, int threads);

/// Measures what it costs when files or light miss the truth by what an installer may miss; the first entry is without
/// any mistake. In the modern mode; centres and directions are not measured.
std::vector<DetectorCondition> measure_tolerance(int threads);

/// Measures each kind of luminaire in each state, and what is none, below ceilings of the renderer's catalogue; the
/// last entries are over all luminaires lit, half and off, over all that is none, and over all luminaires.
std::vector<DetectorCondition> measure_luminaires(const std::string& mode, int threads);

}  // namespace luminav
