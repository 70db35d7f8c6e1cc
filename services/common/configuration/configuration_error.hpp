#pragma once

#include <stdexcept>

namespace luminav {

/// A file that a user wrote is wrong; the message names file, line, key and what is allowed.
class ConfigurationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace luminav
