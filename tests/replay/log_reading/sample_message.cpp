#include "tests/replay/log_reading/sample_message.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <map>
#include <stdexcept>

namespace luminav {
namespace {

constexpr std::uint64_t kNumber = 2;
constexpr double kReal = 0.5;
const std::string kText = "sample";

void put(std::vector<std::uint8_t>& data, std::uint64_t bits, std::size_t bytes) {
  for (std::size_t i = bytes; i-- > 0;) {
    data.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
  }
}

using Numbers = std::map<std::string, std::int64_t>;

void put_fields(const MessageSchemas& schemas, const TypeSchema& type, const Numbers& numbers,
                std::vector<std::uint8_t>& data);

void put_value(const MessageSchemas& schemas, const FieldSchema& field, const Numbers& numbers,
               std::vector<std::uint8_t>& data) {
  const std::string& type = field.type;
  static const std::map<std::string, std::size_t> integers = {{"int8_t", 1},  {"int16_t", 2}, {"int32_t", 4},
                                                              {"int64_t", 8}, {"byte", 1},    {"boolean", 1}};
  if (const auto integer = integers.find(type); integer != integers.end()) {
    const auto given = numbers.find(field.name);
    const std::uint64_t usual = type == "boolean" ? 1 : kNumber;
    put(data, given != numbers.end() ? static_cast<std::uint64_t>(given->second) : usual, integer->second);
  } else if (type == "double") {
    put(data, std::bit_cast<std::uint64_t>(kReal), 8);
  } else if (type == "float") {
    put(data, std::bit_cast<std::uint32_t>(static_cast<float>(kReal)), 4);
  } else if (type == "string") {
    put(data, kText.size() + 1, 4);
    data.insert(data.end(), kText.begin(), kText.end());
    data.push_back(0);
  } else if (const TypeSchema* nested = schemas.find(type)) {
    put_fields(schemas, *nested, numbers, data);
  } else {
    throw std::runtime_error("no type " + type);
  }
}

void put_fields(const MessageSchemas& schemas, const TypeSchema& type, const Numbers& numbers,
                std::vector<std::uint8_t>& data) {
  for (const FieldSchema& field : type.fields) {
    std::uint64_t elements = 1;
    for (const std::string& dimension : field.dimensions) {
      const bool is_number = std::isdigit(static_cast<unsigned char>(dimension.front())) != 0;
      elements *= is_number ? std::stoull(dimension) : kNumber;
    }
    for (std::uint64_t i = 0; i < elements; ++i) {
      put_value(schemas, field, numbers, data);
    }
  }
}

}  // namespace

std::vector<std::uint8_t> sample_message(const MessageSchemas& schemas, const TypeSchema& type,
                                         const std::map<std::string, std::int64_t>& numbers) {
  std::vector<std::uint8_t> data;
  put(data, type.fingerprint, 8);
  put_fields(schemas, type, numbers, data);
  return data;
}

std::string sample_channel(const TypeSchema& type) {
  std::string channel = type.name.ends_with("_t") ? type.name.substr(0, type.name.size() - 2) : type.name;
  std::transform(channel.begin(), channel.end(), channel.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return channel;
}

}  // namespace luminav
