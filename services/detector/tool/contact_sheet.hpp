#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace luminav {

/// Pictures side by side, each with a caption: what an evaluation shows at one glance.
class ContactSheet {
 public:
  /// `columns` pictures in a row, each drawn `width` [px] wide.
  explicit ContactSheet(int columns = 3, int width = 320) : columns_(columns), width_(width) {}

  /// A colour picture. All should have the same aspect.
  void add(const cv::Mat& picture, const std::string& caption);
  [[nodiscard]] bool empty() const { return tiles_.empty(); }
  /// All of them; black where a row is not full.
  [[nodiscard]] cv::Mat draw() const;

 private:
  int columns_;
  int width_;
  std::vector<cv::Mat> tiles_;
};

}  // namespace luminav
