#include "services/mapper/evidence_file.hpp"

#include <zlib.h>

#include <array>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "services/common/configuration/whole_file.hpp"

namespace luminav {
namespace {

constexpr int kFastCompression = 1;

/// Everything that must agree before cells mean the same place.
struct Header {
  std::array<char, 8> magic = {'L', 'U', 'M', 'E', 'V', 'I', 'D', '1'};
  double resolution = 0.0;
  double origin_x = 0.0;
  double origin_y = 0.0;
  std::int64_t columns = 0;
  std::int64_t rows = 0;
  std::int64_t prior_checksum = 0;  // the same walls, or the evidence belongs to another map
};

Header header_of(const OccupancyGrid& grid) {
  Header header;
  header.resolution = grid.geometry.resolution;
  header.origin_x = grid.geometry.origin.x();
  header.origin_y = grid.geometry.origin.y();
  header.columns = grid.geometry.columns;
  header.rows = grid.geometry.rows;
  std::vector<Bytef> walls(grid.prior.size());
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const bool is_wall = grid.prior[i] == Prior::kOccupied || grid.prior[i] == Prior::kDisputed;
    walls[i] = is_wall ? 2 : static_cast<Bytef>(grid.prior[i]);
  }
  header.prior_checksum = static_cast<std::int64_t>(crc32(0, walls.data(), static_cast<uInt>(walls.size())));
  return header;
}

}  // namespace

void write_evidence(const std::filesystem::path& file, const OccupancyGrid& grid) {
  const Header header = header_of(grid);
  uLongf size = compressBound(static_cast<uLong>(grid.evidence.size()));
  std::vector<Bytef> packed(size);
  if (compress2(packed.data(), &size, reinterpret_cast<const Bytef*>(grid.evidence.data()),
                static_cast<uLong>(grid.evidence.size()), kFastCompression) != Z_OK) {
    throw std::runtime_error("zlib could not compress the evidence");
  }
  if (file.has_parent_path()) {
    std::filesystem::create_directories(file.parent_path());
  }
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof header);
  bytes.append(reinterpret_cast<const char*>(packed.data()), size);
  write_whole_file(file, bytes, Durability::kRenamed);
}

bool read_evidence(const std::filesystem::path& file, OccupancyGrid& grid) {
  std::ifstream in(file, std::ios::binary);
  Header found;
  if (!in.read(reinterpret_cast<char*>(&found), sizeof found)) {
    return false;
  }
  const Header expected = header_of(grid);
  if (std::memcmp(&found, &expected, sizeof found) != 0) {
    return false;
  }
  const std::vector<char> packed((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  std::vector<std::int8_t> cells(grid.evidence.size());
  uLongf size = static_cast<uLongf>(cells.size());
  if (uncompress(reinterpret_cast<Bytef*>(cells.data()), &size, reinterpret_cast<const Bytef*>(packed.data()),
                 static_cast<uLong>(packed.size())) != Z_OK ||
      size != cells.size()) {
    return false;
  }
  grid.evidence = std::move(cells);
  return true;
}

}  // namespace luminav
