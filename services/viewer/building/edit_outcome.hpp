#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace luminav {

/// What became of a person's edit of a file.
struct EditOutcome {
  enum class Fate {
    kWaiting,
    kDone,
    kRefused,
    kAsks  // nothing is written until it comes again with `accepts`
  };
  Fate fate = Fate::kWaiting;
  std::string said{};                // why it was refused
  std::vector<std::string> found{};  // what speaks against it, and did not before
};

constexpr std::string_view name_of(EditOutcome::Fate fate) {
  switch (fate) {
    case EditOutcome::Fate::kWaiting:
      return "waiting";
    case EditOutcome::Fate::kDone:
      return "done";
    case EditOutcome::Fate::kRefused:
      return "refused";
    case EditOutcome::Fate::kAsks:
      return "asks";
  }
  return "";
}

}  // namespace luminav
