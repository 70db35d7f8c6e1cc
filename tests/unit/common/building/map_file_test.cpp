#include "services/common/building/map_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <iterator>
#include <stdexcept>

#include "services/common/geometry/pose2.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

PriorMap sample() {
  PriorMap map{{0.05, {-2.5, 1.0}, 3, 2}, {}};
  map.cells = {Prior::kFree, Prior::kOccupied, Prior::kUnknown, Prior::kUnknown, Prior::kFree, Prior::kFree};
  return map;
}

std::string reading_fails_with(const std::filesystem::path& file) {
  try {
    (void)read_map(file);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(MapFile, ReadsWhatItWrote) {
  const TemporaryFolder folder;
  write_map(folder.path() / "floor.yaml", sample());
  const PriorMap read = read_map(folder.path() / "floor.yaml");
  EXPECT_EQ(read.geometry, sample().geometry);
  EXPECT_EQ(read.cells, sample().cells);
}

TEST(MapFile, IsNotWrittenOverItsOwnPicture) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_map(folder.path() / "floor.pgm", sample()), std::runtime_error);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "floor.pgm"));
}

TEST(MapFile, ReadsRowsFromTheBottomAndThresholds) {
  const TemporaryFolder folder;
  // upper row: black, white; lower row: 206 (probability 0.19, free), 128 (0.5, unknown)
  folder.write("m.pgm", std::string("P5\n# made by hand\n2 2\n255\n") + '\0' + '\xff' + '\xce' + '\x80');
  const auto yaml = folder.write(
      "m.yaml",
      "image: m.pgm\nresolution: 0.1\norigin: [1, 2, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n");
  const PriorMap map = read_map(yaml);
  EXPECT_EQ(map.cells, (std::vector<Prior>{Prior::kFree, Prior::kUnknown, Prior::kOccupied, Prior::kFree}));
  EXPECT_EQ(map.at({1.05, 2.15}), Prior::kOccupied);
}

TEST(MapFile, SaysWhatIsWrongWithAFile) {
  const TemporaryFolder folder;
  EXPECT_NE(reading_fails_with(folder.path() / "none.yaml").find("cannot be read"), std::string::npos);
  const std::string rest = "resolution: 0.1\norigin: [0, 0, 0]\n";
  EXPECT_NE(reading_fails_with(folder.write("a.yaml", rest)).find("must have image"), std::string::npos);
  folder.write("cut.pgm", "P5\n10 10\n255\nabc");
  EXPECT_NE(reading_fails_with(folder.write("b.yaml", "image: cut.pgm\n" + rest)).find("cut off, 3 of 100"),
            std::string::npos);
  folder.write("text.pgm", "P2\n1 1\n255\n0\n");
  EXPECT_NE(
      reading_fails_with(folder.write("c.yaml", "image: text.pgm\n" + rest)).find("must be a PNG or a binary PGM"),
      std::string::npos);
  folder.write("deep.pgm", "P5\n1 1\n65535\n\1\1");
  EXPECT_NE(reading_fails_with(folder.write("d.yaml", "image: deep.pgm\n" + rest)).find("16-bit"), std::string::npos);
  EXPECT_NE(reading_fails_with(folder.write("e.yaml", "image: cut.pgm\nresolution: 0\norigin: [0, 0, 0]\n"))
                .find("resolution = 0"),
            std::string::npos);
  EXPECT_NE(reading_fails_with(folder.write("f.yaml", "image: cut.pgm\nresolution: 0.1\norigin: [0, 0, 0, 1]\n"))
                .find("origin must be [x, y, yaw]"),
            std::string::npos);
  EXPECT_NE(
      reading_fails_with(folder.write("h.yaml", "image: cut.pgm\nmode: colour\n" + rest)).find("trinary, scale or raw"),
      std::string::npos);
  EXPECT_NE(reading_fails_with(folder.write("g.yaml", "image: [\n")).find("g.yaml:"), std::string::npos);
}

TEST(MapFile, RefusesNumbersThatNoMapHas) {
  const TemporaryFolder folder;
  folder.write("dot.pgm", "P5\n1 1\n255\n\1");
  for (const std::string& rest :
       {std::string("resolution: 0.1\norigin: [.nan, 0, 0]\n"), std::string("resolution: 0.1\norigin: [0, .inf, 0]\n"),
        std::string("resolution: 0.1\norigin: [1e300, 0, 0]\n"), std::string("resolution: 1e-300\norigin: [0, 0, 0]\n"),
        std::string("resolution: .nan\norigin: [0, 0, 0]\n"), std::string("resolution: 0.1\norigin: [0, 0, .nan]\n"),
        std::string("resolution: 0.1\norigin: [0, 0, 90]\n"),
        std::string("resolution: 0.1\norigin: [0, 0, 0]\nfree_thresh: -0.1\n"),
        std::string("resolution: 0.1\norigin: [0, 0, 0]\noccupied_thresh: 65\n"),
        std::string("resolution: 0.1\norigin: [0, 0, 0]\nfree_thresh: .nan\n"),
        std::string("resolution: 0.1\norigin: [0, 0, 0]\noccupied_thresh: .nan\n"),
        std::string("resolution: 0.1\norigin: [0, 0, 0]\nfree_thresh: 0.7\noccupied_thresh: 0.3\n")}) {
    EXPECT_NE(reading_fails_with(folder.write("a.yaml", "image: dot.pgm\n" + rest)).find("must be between"),
              std::string::npos)
        << rest;
  }
}

TEST(MapFile, IsNeitherAFolderNorAPipe) {
  const TemporaryFolder folder;
  EXPECT_NE(reading_fails_with(folder.path()).find("cannot be read"), std::string::npos);
  const std::filesystem::path pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_NE(reading_fails_with(pipe).find("cannot be read"), std::string::npos);
  const std::string rest = "resolution: 0.1\norigin: [0, 0, 0]\n";
  EXPECT_NE(reading_fails_with(folder.write("a.yaml", "image: pipe\n" + rest)).find("cannot be read"),
            std::string::npos);
}

// 2 x 2 pixels, grey with opacity: black, white; 206 (free), transparent black
const std::string kPng = [] {
  constexpr unsigned char kBytes[] = {
      0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x00,
      0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x04, 0x00, 0x00, 0x00, 0xd8, 0xbf, 0xc5, 0xaf, 0x00, 0x00, 0x00, 0x12, 0x49,
      0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x60, 0xf8, 0xff, 0xff, 0x3f, 0xc3, 0xb9, 0xff, 0x0c, 0x0c, 0x00, 0x1b, 0x2a,
      0x04, 0xcb, 0xa8, 0xbc, 0x06, 0xba, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  return std::string(std::begin(kBytes), std::end(kBytes));
}();

TEST(MapFile, ReadsAPngWhereWhatIsTransparentIsUnknown) {
  const TemporaryFolder folder;
  folder.write("m.png", kPng);
  const PriorMap map = read_map(folder.write("m.yaml", "image: m.png\nresolution: 0.1\norigin: [1, 2, 0]\n"));
  EXPECT_EQ(map.cells, (std::vector<Prior>{Prior::kFree, Prior::kUnknown, Prior::kOccupied, Prior::kFree}));
  folder.write("cut.png", kPng.substr(0, kPng.size() - 30));
  const std::string said =
      reading_fails_with(folder.write("c.yaml", "image: cut.png\nresolution: 0.1\norigin: [0, 0, 0]\n"));
  EXPECT_NE(said.find("not a whole PNG"), std::string::npos) << said;
}

TEST(MapFile, ReadsEachModeAndItsNegative) {
  const TemporaryFolder folder;
  folder.write("m.pgm", std::string("P5\n4 1\n255\n") + '\0' + '\x32' + '\x64' + '\xff');  // 0, 50, 100, 255
  const auto read = [&](const std::string& more) {
    return read_map(folder.write("m.yaml", "image: m.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n" + more)).cells;
  };
  using enum Prior;
  const std::vector<Prior> plain{kOccupied, kOccupied, kUnknown, kFree};
  EXPECT_EQ(read(""), plain);
  EXPECT_EQ(read("mode: trinary\nnegate: false\n"), plain);
  EXPECT_EQ(read("mode: scale\n"), plain);
  for (const char* negate : {"negate: 1\n", "negate: true\n"}) {
    EXPECT_EQ(read(negate), (std::vector<Prior>{kFree, kUnknown, kUnknown, kOccupied})) << negate;
  }
  EXPECT_EQ(read("mode: raw\n"), (std::vector<Prior>{kFree, kUnknown, kOccupied, kUnknown}));
}

TEST(MapFile, TurnsAMapWhoseOriginHasAYaw) {
  const TemporaryFolder folder;
  // three cells in a row: wall, free, unknown; turned by a quarter they stand above each other
  folder.write("m.pgm", std::string("P5\n3 1\n255\n") + '\0' + '\xff' + '\xcd');
  const PriorMap map =
      read_map(folder.write("m.yaml", "image: m.pgm\nresolution: 0.1\norigin: [5, 1, 1.5707963267948966]\n"));
  EXPECT_EQ(map.geometry.columns, 1);
  EXPECT_EQ(map.geometry.rows, 3);
  EXPECT_EQ(map.at({4.95, 1.05}), Prior::kOccupied);
  EXPECT_EQ(map.at({4.95, 1.15}), Prior::kFree);
  EXPECT_EQ(map.at({4.95, 1.25}), Prior::kUnknown);
}

TEST(MapFile, KeepsAThinWallWholeWhenItIsTurned) {
  const TemporaryFolder folder;
  std::string picture = "P5\n41 41\n255\n";
  for (int i = 0; i < 41 * 41; ++i) {
    picture += i / 41 == 20 ? '\0' : '\xff';
  }
  folder.write("m.pgm", picture);
  const PriorMap map = read_map(folder.write("m.yaml", "image: m.pgm\nresolution: 0.1\norigin: [0, 0, 0.4]\n"));
  const Pose2 world_from_map{0.0, 0.0, 0.4};
  for (double u = 0.05; u < 4.0; u += 0.01) {  // across the wall at every place
    bool is_stopped = false;
    for (double v = 1.6; v < 2.6; v += 0.005) {
      is_stopped = is_stopped || map.at(world_from_map * Eigen::Vector2d(u, v)) == Prior::kOccupied;
    }
    ASSERT_TRUE(is_stopped) << u;
  }
}

}  // namespace
}  // namespace luminav
