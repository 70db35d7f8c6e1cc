#include "services/common/building/map_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <stdexcept>

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
  EXPECT_NE(reading_fails_with(folder.write("c.yaml", "image: text.pgm\n" + rest)).find("not a binary PGM"),
            std::string::npos);
  folder.write("deep.pgm", "P5\n1 1\n65535\n\1\1");
  EXPECT_NE(reading_fails_with(folder.write("d.yaml", "image: deep.pgm\n" + rest)).find("16-bit"), std::string::npos);
  EXPECT_NE(reading_fails_with(folder.write("e.yaml", "image: cut.pgm\nresolution: 0\norigin: [0, 0, 0]\n"))
                .find("resolution = 0"),
            std::string::npos);
  EXPECT_NE(reading_fails_with(folder.write("f.yaml", "image: cut.pgm\nresolution: 0.1\norigin: [0, 0, 1.5]\n"))
                .find("turned maps"),
            std::string::npos);
  EXPECT_NE(reading_fails_with(folder.write("g.yaml", "image: [\n")).find("g.yaml:"), std::string::npos);
}

TEST(MapFile, RefusesNumbersThatNoMapHas) {
  const TemporaryFolder folder;
  folder.write("dot.pgm", "P5\n1 1\n255\n\1");
  for (const std::string& rest :
       {std::string("resolution: 0.1\norigin: [.nan, 0, 0]\n"), std::string("resolution: 0.1\norigin: [0, .inf, 0]\n"),
        std::string("resolution: 0.1\norigin: [1e300, 0, 0]\n"), std::string("resolution: 1e-300\norigin: [0, 0, 0]\n"),
        std::string("resolution: .nan\norigin: [0, 0, 0]\n"),
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

}  // namespace
}  // namespace luminav
