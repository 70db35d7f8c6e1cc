#include "services/viewer/http/request_fields.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace luminav {

using Json = nlohmann::json;

Json read_object(const std::string& body, std::initializer_list<std::string_view> known) {
  // nothing that is asked for here is nested deeply
  const auto shallow = [](int depth, Json::parse_event_t, Json&) {
    if (depth > 8) {
      throw RequestError("the request is nested too deeply");
    }
    return true;
  };
  const Json object = Json::parse(body, shallow, false);
  if (!object.is_object()) {
    throw RequestError("the request must be a JSON object");
  }
  for (const auto& [key, value] : object.items()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      throw RequestError(fmt::format("unknown key; known: {}", fmt::join(known, ", ")));
    }
  }
  return object;
}

double number(const Json& object, const char* key, double min, double max) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number()) {
    throw RequestError(fmt::format("{}: must be a number", key));
  }
  const double value = found->get<double>();
  if (!std::isfinite(value) || value < min || value > max) {
    throw RequestError(fmt::format("{}: must be {} to {}", key, min, max));
  }
  return value;
}

std::int64_t integer(const Json& object, const char* key, std::int64_t min, std::int64_t max) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number_integer()) {
    throw RequestError(fmt::format("{}: must be a whole number", key));
  }
  // beyond int64 it is unsigned, or a floating-point number already
  const bool is_huge = found->is_number_unsigned() && found->get<std::uint64_t>() > static_cast<std::uint64_t>(max);
  const std::int64_t value = is_huge ? 0 : found->get<std::int64_t>();
  if (is_huge || value < min || value > max) {
    throw RequestError(fmt::format("{}: must be {} to {}", key, min, max));
  }
  return value;
}

bool boolean(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_boolean()) {
    throw RequestError(fmt::format("{}: must be true or false", key));
  }
  return found->get<bool>();
}

std::string text(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_string()) {
    throw RequestError(fmt::format("{}: must be a text", key));
  }
  return found->get<std::string>();
}

std::string line(const Json& object, const char* key, std::size_t max_bytes) {
  std::string said = text(object, key);
  const bool is_printable =
      std::all_of(said.begin(), said.end(), [](unsigned char letter) { return letter >= ' ' && letter != 0x7f; });
  if (said.size() > max_bytes || !is_printable) {
    throw RequestError(fmt::format("{}: must be one line of {} bytes at most", key, max_bytes));
  }
  return said;
}

std::string name(const Json& object, const char* key) {
  constexpr std::size_t kMaxName = 60;  // [bytes]
  std::string said = line(object, key, kMaxName);
  if (said.empty() || said.front() == ' ' || said.back() == ' ') {
    throw RequestError(fmt::format("{}: must be a name of 1 to {} letters", key, kMaxName));
  }
  return said;
}

const Json& part(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) {
    throw RequestError(fmt::format("{}: is missing", key));
  }
  return *found;
}

void check_item(const Json& item, const char* list, std::initializer_list<std::string_view> known) {
  if (!item.is_object()) {
    throw RequestError(fmt::format("{}: each must be an object", list));
  }
  for (const auto& [key, value] : item.items()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      throw RequestError(fmt::format("{}: known keys are {}", list, fmt::join(known, ", ")));
    }
  }
}

std::int8_t choice(const Json& object, const char* key, std::initializer_list<std::string_view> words) {
  const std::string word = text(object, key);
  const auto* found = std::find(words.begin(), words.end(), word);
  if (found == words.end()) {
    throw RequestError(fmt::format("{}: must be one of {}", key, fmt::join(words, ", ")));
  }
  return static_cast<std::int8_t>(found - words.begin());
}

}  // namespace luminav
