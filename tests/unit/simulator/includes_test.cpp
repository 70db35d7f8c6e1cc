#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

/// Names of the project's own files that a source includes.
std::vector<std::string> includes_of(const fs::path& file) {
  std::vector<std::string> names;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const std::string prefix = "#include \"";
    if (line.starts_with(prefix)) {
      names.push_back(line.substr(prefix.size(), line.find('"', prefix.size()) - prefix.size()));
    }
  }
  return names;
}

bool is_source(const fs::path& file) {
  return file.extension() == ".hpp" || file.extension() == ".cpp";
}

bool is_allowed(const std::string& include, bool may_talk) {
  if (!include.starts_with("services/")) {
    return true;
  }
  return include.starts_with("services/common/geometry/") || include.starts_with("services/common/building/") ||
         include.starts_with("services/common/configuration/") ||
         include == "services/common/image/grey_image.hpp" ||  // pixels: what a frame source hands over
         (may_talk && include.starts_with("services/common/process/"));
}

/// Checks the sources of a driver's folder whose names begin with a prefix; returns how many there were.
int check_folder(const std::string& folder, const std::string& prefix) {
  int sources = 0;
  const fs::path path = fs::path(LUMINAV_SOURCE_DIR) / "drivers" / folder;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path)) {
    const std::string stem = entry.path().stem().string();
    if (!is_source(entry.path()) || !stem.starts_with(prefix)) {
      continue;
    }
    ++sources;
    const bool may_talk = stem == "main" || stem.ends_with("_node");
    for (const std::string& include : includes_of(entry.path())) {
      EXPECT_TRUE(is_allowed(include, may_talk)) << entry.path() << " includes " << include;
    }
  }
  return sources;
}

TEST(SimulatorIncludes, TakeNothingFromTheServicesButWhatABuildingIs) {
  EXPECT_GT(check_folder("simulator", ""), 20);
}

TEST(SimulatorIncludes, HoldForTheSimulatedFrameSourceToo) {
  EXPECT_GT(check_folder("camera/simulated", ""), 0);
}

TEST(SimulatorIncludes, AreFoundAndJudged) {
  const fs::path file = fs::path(testing::TempDir()) / "luminav_includes.cpp";
  std::ofstream(file) << "#include <vector>\n#include \"services/localizer/ekf.hpp\"\n#include \"drivers/x.hpp\"\n";
  const std::vector<std::string> includes = includes_of(file);
  ASSERT_EQ(includes.size(), 2U);
  EXPECT_FALSE(is_allowed(includes[0], true));
  EXPECT_TRUE(is_allowed(includes[1], false));
  EXPECT_FALSE(is_allowed("services/common/process/channels.hpp", false));
  EXPECT_TRUE(is_allowed("services/common/process/channels.hpp", true));
}

// No service but the viewer knows what is true.
TEST(SimulatorIncludes, LeaveTheTruthToTheViewer) {
  int sources = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(LUMINAV_SOURCE_DIR) / "services")) {
    const std::string path = entry.path().string();
    if (!is_source(entry.path()) || path.find("/services/viewer/") != std::string::npos ||
        path.find("/services/common/") != std::string::npos) {
      continue;
    }
    ++sources;
    std::ifstream in(entry.path());
    const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    for (const char* word : {"sim_truth_t", "kSimTruth", "SIM_TRUTH", "drivers/simulator/"}) {
      EXPECT_EQ(text.find(word), std::string::npos) << path << " speaks of " << word;
    }
  }
  RecordProperty("sources", sources);
}

}  // namespace
