#include "services/jobs/storage/photo_store.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "services/common/configuration/whole_file.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;

std::string_view bytes_of(const camera_image_t& image) {
  return {reinterpret_cast<const char*>(image.data.data()), image.data.size()};
}

}  // namespace

void PhotoStore::keep(const camera_image_t& image, const PhotoWish& wish,
                      const std::optional<Pose2>& world_from_robot) const {
  if (folder_.empty()) {
    return;
  }
  fs::create_directories(folder_);
  const std::string name = fmt::format("{:016}-{}-{}", image.utime, wish.job, wish.stop);
  const bool is_jpeg = image.format == camera_image_t::FORMAT_JPEG;
  const std::string header = is_jpeg ? "" : fmt::format("P5\n{} {}\n255\n", image.width, image.height);
  nlohmann::json about = {{"utime", image.utime}, {"place", wish.place}, {"job", wish.job}, {"stop", wish.stop}};
  if (world_from_robot) {
    about["pose"] = {world_from_robot->x, world_from_robot->y, world_from_robot->theta};
  }
  write_whole_file(folder_ / (name + ".json"),
                   about.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n", Durability::kRenamed);
  write_whole_file(folder_ / (name + (is_jpeg ? ".jpg" : ".pgm")), header + std::string(bytes_of(image)),
                   Durability::kRenamed);
  forget_oldest();
}

void PhotoStore::forget_oldest() const {
  std::set<std::string> names;  // by rising stamps
  for (const auto& entry : fs::directory_iterator(folder_)) {
    names.insert(entry.path().stem().string());
  }
  while (names.size() > kMaxPhotos) {
    for (const char* part : {".json", ".jpg", ".pgm"}) {
      fs::remove(folder_ / (*names.begin() + part));
    }
    names.erase(names.begin());
  }
}

}  // namespace luminav
