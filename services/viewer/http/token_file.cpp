#include "services/viewer/http/token_file.hpp"

#include <fmt/format.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <vector>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/configuration/whole_file.hpp"

namespace luminav {
namespace {

constexpr std::size_t kTokenBytes = 12;
constexpr std::size_t kShortest = 16;  // [letters] of a token that somebody chose
constexpr std::size_t kLongest = 128;

/// What is written meanwhile is this user's alone.
class OnlyForMe {
 public:
  OnlyForMe() : previous_(umask(077)) {}
  ~OnlyForMe() { umask(previous_); }
  OnlyForMe(const OnlyForMe&) = delete;
  OnlyForMe& operator=(const OnlyForMe&) = delete;

 private:
  mode_t previous_;
};

bool is_token(const std::string& text) {
  return text.size() >= kShortest && text.size() <= kLongest &&
         std::all_of(text.begin(), text.end(),
                     [](unsigned char letter) { return std::isalnum(letter) != 0 || letter == '-' || letter == '_'; });
}

void check_who_may_read(const std::filesystem::path& file) {
  struct stat status {};
  if (lstat(file.c_str(), &status) != 0 || !S_ISREG(status.st_mode) || status.st_uid != geteuid()) {
    throw ConfigurationError(fmt::format("{}: must be a file of this user", file.string()));
  }
  if ((status.st_mode & 077) != 0) {
    throw ConfigurationError(
        fmt::format("{}: others may read or change it: chmod 600, and a new token if they did", file.string()));
  }
}

}  // namespace

std::string random_hex(std::size_t bytes) {
  std::vector<unsigned char> random(bytes);
  if (getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size())) {
    throw std::runtime_error("the kernel gives no random numbers");
  }
  std::string hex;
  for (const unsigned char byte : random) {
    hex += fmt::format("{:02x}", byte);
  }
  return hex;
}

std::string read_or_make_token(const std::filesystem::path& file) {
  if (std::filesystem::exists(std::filesystem::symlink_status(file))) {
    check_who_may_read(file);
    std::string text = read_whole_file(file);
    text.erase(std::find_if(text.begin(), text.end(), [](unsigned char letter) { return std::isspace(letter) != 0; }),
               text.end());
    if (is_token(text)) {
      return text;
    }
    if (!text.empty()) {  // an empty one is what a power cut may leave
      throw ConfigurationError(
          fmt::format("{}: a token is {} to {} letters, digits, - and _", file.string(), kShortest, kLongest));
    }
  }
  const OnlyForMe guard;
  if (file.has_parent_path()) {
    std::filesystem::create_directories(file.parent_path());
  }
  const std::string token = random_hex(kTokenBytes);
  write_whole_file(file, token + "\n");
  return token;
}

}  // namespace luminav
