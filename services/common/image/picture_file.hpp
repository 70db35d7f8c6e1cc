#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace luminav {

/// Writes a picture in the format of the file's ending (without one: PNG), whole or
/// not at all; `options` are pairs of a cv::IMWRITE_ flag and its value. Throws std::runtime_error when it cannot be
/// written.
void write_picture(const std::filesystem::path& file, const cv::Mat& picture, const std::vector<int>& options = {});

}  // namespace luminav
