#include "services/common/image/picture_file.hpp"

#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "services/common/configuration/whole_file.hpp"

namespace luminav {

void write_picture(const std::filesystem::path& file, const cv::Mat& picture, const std::vector<int>& options) {
  std::vector<unsigned char> bytes;
  const std::string ending = file.has_extension() ? file.extension().string() : ".png";
  if (!cv::haveImageWriter(ending) || !cv::imencode(ending, picture, bytes, options)) {
    throw std::runtime_error(file.string() + ": cannot be written as a picture");
  }
  write_whole_file(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace luminav
