#include "services/common/configuration/whole_file.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <iterator>
#include <stdexcept>

namespace luminav {
namespace {

TEST(WholeFile, ReadsWhatItWrote) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "whole_file_test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const std::string bytes{"a\0b\r\n\xff", 6};
  write_whole_file(folder / "file", "what was there before");
  write_whole_file(folder / "file", bytes);
  EXPECT_EQ(read_whole_file(folder / "file"), bytes);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1) << "nothing temporary is left";
}

TEST(WholeFile, SaysWhichFileItCannotReadOrWrite) {
  const std::filesystem::path missing = std::filesystem::path(testing::TempDir()) / "no such folder" / "file";
  for (const auto& act : {std::function<void()>([&] { read_whole_file(missing); }),
                          std::function<void()>([&] { write_whole_file(missing, "bytes"); })}) {
    try {
      act();
      FAIL() << "accepted";
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(missing.string()), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace luminav
