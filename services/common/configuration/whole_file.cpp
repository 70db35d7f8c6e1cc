#include "services/common/configuration/whole_file.hpp"

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>

namespace luminav {

std::string read_whole_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream bytes;
  bytes << in.rdbuf();
  if (!in) {
    throw std::runtime_error(file.string() + ": cannot be read");
  }
  return bytes.str();
}

void write_whole_file(const std::filesystem::path& file, std::string_view bytes) {
  const std::filesystem::path temporary = file.string() + ".tmp";
  std::ofstream out(temporary, std::ios::binary);
  out << bytes;
  out.close();
  std::error_code error;
  if (out) {
    std::filesystem::rename(temporary, file, error);
  }
  if (!out || error) {
    std::filesystem::remove(temporary, error);  // half a file on a full disk helps nobody
    throw std::runtime_error(file.string() + ": cannot be written");
  }
}

}  // namespace luminav
