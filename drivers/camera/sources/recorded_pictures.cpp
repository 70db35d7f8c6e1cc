#include "drivers/camera/sources/recorded_pictures.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "drivers/camera/sources/pgm_file.hpp"

namespace luminav {
namespace {

/// A file's bytes, paged in as they are looked at.
class MappedFile {
 public:
  explicit MappedFile(const std::filesystem::path& file) {
    const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat status {};
    if (descriptor < 0 || fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
      if (descriptor >= 0) {
        close(descriptor);
      }
      throw std::runtime_error("cannot read " + file.string());
    }
    size_ = static_cast<std::size_t>(status.st_size);
    if (size_ > 0) {
      data_ = mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, descriptor, 0);
    }
    close(descriptor);
    if (data_ == MAP_FAILED) {
      throw std::runtime_error("cannot map " + file.string());
    }
  }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile() {
    if (data_ != nullptr) {
      munmap(data_, size_);
    }
  }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return {static_cast<const std::uint8_t*>(data_), size_}; }

 private:
  void* data_ = nullptr;
  std::size_t size_ = 0;
};

/// End of the JPEG that begins at `begin` (ITU T.81, B.1.1): segments by their length, so that a thumbnail inside one
/// is no picture of its own, and entropy-coded data up to the next marker. 0 = it is cut or no JPEG.
std::size_t end_of_jpeg(std::span<const std::uint8_t> bytes, std::size_t begin) {
  std::size_t at = begin + 2;
  while (at + 1 < bytes.size()) {
    if (bytes[at] != 0xFF) {
      return 0;
    }
    const int marker = bytes[at + 1];
    if (marker == 0xFF) {  // filling
      ++at;
      continue;
    }
    if (marker == 0xD9) {
      return at + 2;
    }
    if (at + 4 > bytes.size()) {
      return 0;
    }
    const std::size_t length = 256U * bytes[at + 2] + bytes[at + 3];
    at += 2 + length;
    if (marker == 0xDA) {  // scan: entropy-coded data follow; in them FF 00 and restarts FF D0..D7 are no markers
      while (at + 1 < bytes.size() &&
             !(bytes[at] == 0xFF && bytes[at + 1] != 0 && (bytes[at + 1] < 0xD0 || bytes[at + 1] > 0xD7))) {
        ++at;
      }
    }
  }
  return 0;
}

bool is_picture(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return extension == ".jpg" || extension == ".jpeg" || extension == ".pgm";
}

}  // namespace

std::vector<ByteRange> find_jpegs(std::span<const std::uint8_t> bytes) {
  std::vector<ByteRange> found;
  std::size_t at = 0;
  while (at + 2 < bytes.size()) {
    if (bytes[at] == 0xFF && bytes[at + 1] == 0xD8 && bytes[at + 2] == 0xFF) {
      const std::size_t end = end_of_jpeg(bytes, at);
      if (end > at) {
        found.push_back({at, end - at});
        at = end;
        continue;
      }
    }
    ++at;
  }
  return found;
}

RecordedPictures::RecordedPictures(std::string name, std::vector<Picture> pictures, double rate)
    : name_(std::move(name)), pictures_(std::move(pictures)), period_(std::llround(1e6 / rate)) {
  if (pictures_.empty()) {
    throw std::runtime_error("no JPEG or PGM picture in " + name_);
  }
}

RecordedPictures RecordedPictures::in_folder(const std::filesystem::path& folder, double rate) {
  if (!std::filesystem::is_directory(folder)) {
    throw std::runtime_error(folder.string() + " is not a folder");
  }
  std::vector<Picture> pictures;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.is_regular_file() && is_picture(entry.path())) {
      pictures.push_back({entry.path(), {0, entry.file_size()}});
    }
  }
  std::sort(pictures.begin(), pictures.end(), [](const Picture& a, const Picture& b) { return a.file < b.file; });
  return {folder.string(), std::move(pictures), rate};
}

RecordedPictures RecordedPictures::in_file(const std::filesystem::path& file, double rate) {
  const MappedFile mapped(file);
  std::vector<Picture> pictures;
  if (mapped.bytes().size() > 2 && mapped.bytes()[0] == 'P' && mapped.bytes()[1] == '5') {
    pictures.push_back({file, {0, mapped.bytes().size()}});
  }
  for (const ByteRange& range : find_jpegs(mapped.bytes())) {
    pictures.push_back({file, range});
  }
  return {file.string(), std::move(pictures), rate};
}

bool RecordedPictures::read(const Picture& picture, GreyImage& image) {
  std::ifstream stream(picture.file, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(picture.range.offset));
  bytes_.resize(picture.range.size);
  stream.read(reinterpret_cast<char*>(bytes_.data()), static_cast<std::streamsize>(bytes_.size()));
  return stream && (read_pgm(bytes_, image) || decoder_.decode(bytes_, image));
}

bool RecordedPictures::take(std::int64_t now, Frame& frame) {
  if (now < due_.value_or(now) || next_ == pictures_.size()) {
    return false;
  }
  // The next one a period after this one was due, or after now when somebody slept.
  const std::int64_t this_due = due_.value_or(now);
  due_ = now - this_due < period_ ? this_due + period_ : now + period_;
  while (next_ < pictures_.size()) {
    if (read(pictures_[next_++], frame.image)) {
      frame.utime = now;
      frame.exposure_us = 0.0;
      frame.gain = 1.0;
      frame.row_time_us = 0.0;
      return true;
    }
    ++damaged_;
  }
  return false;
}

std::string RecordedPictures::fault() const {
  return next_ < pictures_.size() ? ""
                                  : name_ + ": all " + std::to_string(pictures_.size()) + " pictures shown, " +
                                        std::to_string(damaged_) + " of them could not be read";
}

std::string RecordedPictures::shortcoming() const {
  return damaged_ == 0 ? "" : std::to_string(damaged_) + " pictures in " + name_ + " could not be read";
}

std::string RecordedPictures::description() const {
  return std::to_string(pictures_.size()) + " pictures from " + name_;
}

}  // namespace luminav
