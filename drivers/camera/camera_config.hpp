#pragma once

#include <filesystem>
#include <string>

#include "drivers/camera/exposure_control.hpp"
#include "services/common/configuration/robot_file.hpp"

namespace luminav {

enum class ImageEncoding { kJpeg, kMono8 };

/// The camera driver's settings, from table [camera_driver] of the robot's file.
struct CameraConfig {
  std::string robot = "p3dx";
  CameraDescription camera;                       // as believed; gives the picture's size and row time to devices
  int camera_index = 0;                           // in CAMERA_IMAGE: 0 = the first
  double rate = 15.0;                             // [frames/s]
  ImageEncoding encoding = ImageEncoding::kJpeg;  // mono8 only within one program: it does not fit into a datagram
  int quality = 85;                               // JPEG quality 1..100 to begin with
  int max_size = 60'000;                          // [bytes] of a JPEG; the quality is lowered until it fits
  ExposureParams exposure;
};

/// Reads the robot's file strictly. Throws ConfigurationError.
CameraConfig read_camera_config(const std::filesystem::path& robot_file);

}  // namespace luminav
