#include "tests/replay/log_reading/message_schema.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cctype>
#include <cstring>
#include <sstream>
#include <stdexcept>

namespace luminav {
namespace {

constexpr int kDeepest = 8;                      // of types within types
constexpr std::size_t kMaxElements = 1U << 24U;  // of one array

const std::map<std::string, std::size_t, std::less<>> kPrimitives = {{"int8_t", 1},  {"int16_t", 2}, {"int32_t", 4},
                                                                     {"int64_t", 8}, {"byte", 1},    {"boolean", 1},
                                                                     {"float", 4},   {"double", 8},  {"string", 0}};

// lcm-gen's hash, from its documentation of the type fingerprint: over names, primitive types and dimensions.
std::int64_t hash_char(std::int64_t value, char c) {
  const auto shifted = static_cast<std::int64_t>(static_cast<std::uint64_t>(value) << 8);
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(shifted ^ (value >> 55)) +
                                   static_cast<std::uint64_t>(static_cast<std::int64_t>(c)));
}

std::int64_t hash_text(std::int64_t value, const std::string& text) {
  value = hash_char(value, static_cast<char>(text.size()));
  for (const char c : text) {
    value = hash_char(value, c);
  }
  return value;
}

std::string trimmed(std::string text) {
  const auto is_space = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  while (!text.empty() && is_space(text.back())) {
    text.pop_back();
  }
  std::size_t first = 0;
  while (first < text.size() && is_space(text[first])) {
    ++first;
  }
  return text.substr(first);
}

/// "[m] world, ..." gives "m".
std::string unit_of(const std::string& comment) {
  const std::string text = trimmed(comment);
  const std::size_t end = text.find(']');
  return text.empty() || text.front() != '[' || end == std::string::npos ? "" : text.substr(1, end - 1);
}

std::string without_package(const std::string& type) {
  const std::size_t dot = type.rfind('.');
  return dot == std::string::npos ? type : type.substr(dot + 1);
}

/// Several members may share a declaration: "double x, y;".
void parse_members(const std::string& statement, const std::string& comment, TypeSchema& type) {
  std::istringstream words(statement);
  std::string type_name;
  words >> type_name;
  std::string rest;
  std::getline(words, rest, '\0');
  std::istringstream members(rest);
  for (std::string member; std::getline(members, member, ',');) {
    FieldSchema field;
    field.type = without_package(type_name);
    field.unit = unit_of(comment);
    std::size_t open = member.find('[');
    field.name = trimmed(member.substr(0, open));
    while (open != std::string::npos) {
      const std::size_t close = member.find(']', open);
      if (close == std::string::npos) {
        throw std::runtime_error(fmt::format("{}: {} lacks a bracket", type.name, statement));
      }
      field.dimensions.push_back(trimmed(member.substr(open + 1, close - open - 1)));
      open = member.find('[', close);
    }
    if (field.name.empty()) {
      throw std::runtime_error(fmt::format("{}: cannot understand '{}'", type.name, statement));
    }
    type.fields.push_back(std::move(field));
  }
}

/// The project's style of .lcm files: one statement per line, its comment behind it.
TypeSchema parse_type(const std::string& text) {
  TypeSchema type;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t slashes = line.find("//");
    const std::string comment = slashes == std::string::npos ? "" : line.substr(slashes + 2);
    std::istringstream statements(line.substr(0, slashes));
    for (std::string statement; std::getline(statements, statement, ';');) {
      statement = trimmed(statement);
      if (statement.starts_with("package ")) {
        type.package = trimmed(statement.substr(8));
      } else if (statement.starts_with("struct ")) {
        type.name = trimmed(statement.substr(7, statement.find('{') - 7));
      } else if (!statement.empty() && statement != "{" && statement != "}" && !statement.starts_with("const ")) {
        parse_members(statement, comment, type);
      }
    }
  }
  if (type.name.empty()) {
    throw std::runtime_error("a text without a struct is no message type");
  }
  return type;
}

}  // namespace

struct MessageSchemas::Cursor {
  const std::vector<std::uint8_t>& data;
  std::size_t longest;
  std::size_t at = 8;
  std::vector<FieldValue> values{};
  int depth = 0;

  bool take(std::size_t size, std::uint64_t& bits) {
    if (data.size() - at < size) {
      return false;
    }
    bits = 0;
    for (std::size_t i = 0; i < size; ++i) {
      bits = (bits << 8) | data[at++];
    }
    return true;
  }
};

MessageSchemas::MessageSchemas(const std::vector<std::string>& texts) {
  for (const std::string& text : texts) {
    TypeSchema type = parse_type(text);
    types_[type.name] = std::move(type);
  }
  for (auto& [name, type] : types_) {
    type.fingerprint = hash(type, 0);
    by_fingerprint_[type.fingerprint] = &type;
  }
}

std::uint64_t MessageSchemas::hash(const TypeSchema& type, int depth) const {
  if (depth > kDeepest) {
    throw std::runtime_error(type.name + ": types nest too deeply");
  }
  std::int64_t value = 0x12345678;
  std::uint64_t nested = 0;
  for (const FieldSchema& field : type.fields) {
    value = hash_text(value, field.name);
    if (kPrimitives.contains(field.type)) {
      value = hash_text(value, field.type);
    } else if (const TypeSchema* other = find(field.type)) {
      nested += hash(*other, depth + 1);
    } else {
      throw std::runtime_error(fmt::format("{}: unknown type {}", type.name, field.type));
    }
    value = hash_char(value, static_cast<char>(field.dimensions.size()));
    for (const std::string& dimension : field.dimensions) {
      const bool is_constant = std::isdigit(static_cast<unsigned char>(dimension.front())) != 0;
      value = hash_char(value, is_constant ? 0 : 1);
      value = hash_text(value, dimension);
    }
  }
  return std::rotl(static_cast<std::uint64_t>(value) + nested, 1);
}

const TypeSchema* MessageSchemas::find(std::uint64_t fingerprint) const {
  const auto found = by_fingerprint_.find(fingerprint);
  return found == by_fingerprint_.end() ? nullptr : found->second;
}

const TypeSchema* MessageSchemas::find(std::string_view name) const {
  const auto found = types_.find(std::string(name));
  return found == types_.end() ? nullptr : &found->second;
}

bool MessageSchemas::decode_fields(const TypeSchema& type, const std::string& prefix, Cursor& cursor) const {
  if (++cursor.depth > kDeepest) {
    return false;
  }
  std::map<std::string, std::int64_t> counts;
  for (const FieldSchema& field : type.fields) {
    std::size_t elements = 1;
    for (const std::string& dimension : field.dimensions) {
      const auto named = counts.find(dimension);
      const bool is_number = std::isdigit(static_cast<unsigned char>(dimension.front())) != 0;
      if (!is_number && named == counts.end()) {
        return false;
      }
      const std::int64_t size = is_number ? std::stoll(dimension) : named->second;
      if (size < 0 || static_cast<std::size_t>(size) > kMaxElements) {
        return false;
      }
      elements *= static_cast<std::size_t>(size);
    }
    const auto primitive = kPrimitives.find(field.type);
    if (field.type == "byte" && !field.dimensions.empty()) {
      if (cursor.data.size() - cursor.at < elements) {
        return false;
      }
      cursor.at += elements;
      continue;
    }
    for (std::size_t i = 0; i < elements; ++i) {
      const std::string path = prefix + field.name + (field.dimensions.empty() ? "" : fmt::format("[{}]", i));
      std::uint64_t bits = 0;
      if (primitive == kPrimitives.end()) {
        const std::size_t before = cursor.values.size();
        if (!decode_fields(*find(field.type), path + ".", cursor)) {
          return false;
        }
        if (i >= cursor.longest) {
          cursor.values.erase(cursor.values.begin() + static_cast<std::ptrdiff_t>(before), cursor.values.end());
        }
        continue;
      }
      FieldValue value{path, field.unit, std::int64_t{0}};
      if (field.type == "string") {
        if (!cursor.take(4, bits) || bits == 0 || cursor.data.size() - cursor.at < bits) {
          return false;
        }
        value.value = std::string(cursor.data.begin() + static_cast<std::ptrdiff_t>(cursor.at),
                                  cursor.data.begin() + static_cast<std::ptrdiff_t>(cursor.at + bits - 1));
        cursor.at += bits;
      } else if (!cursor.take(primitive->second, bits)) {
        return false;
      } else if (field.type == "double") {
        value.value = std::bit_cast<double>(bits);
      } else if (field.type == "float") {
        value.value = static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
      } else if (field.type == "byte") {
        value.value = static_cast<std::int64_t>(bits);
      } else {
        const std::size_t unused = 64 - 8 * primitive->second;
        value.value = static_cast<std::int64_t>(bits << unused) >> unused;  // the sign
        counts[field.name] = std::get<std::int64_t>(value.value);
      }
      if (i < cursor.longest) {
        cursor.values.push_back(std::move(value));
      }
    }
  }
  --cursor.depth;
  return true;
}

std::optional<std::vector<FieldValue>> MessageSchemas::decode(const std::vector<std::uint8_t>& data,
                                                              std::size_t longest) const {
  if (data.size() < 8) {
    return std::nullopt;
  }
  std::uint64_t fingerprint = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    fingerprint = (fingerprint << 8) | data[i];
  }
  const TypeSchema* type = find(fingerprint);
  Cursor cursor{data, longest};
  if (type == nullptr || !decode_fields(*type, "", cursor)) {
    return std::nullopt;
  }
  return std::move(cursor.values);
}

std::optional<std::int64_t> MessageSchemas::integer(const std::vector<std::uint8_t>& data,
                                                    std::string_view member) const {
  if (data.size() < 8) {
    return std::nullopt;
  }
  Cursor cursor{data, 0};
  cursor.at = 0;
  std::uint64_t bits = 0;
  const TypeSchema* type = cursor.take(8, bits) ? find(bits) : nullptr;
  if (type == nullptr) {
    return std::nullopt;
  }
  for (const FieldSchema& field : type->fields) {
    const auto primitive = kPrimitives.find(field.type);
    if (primitive == kPrimitives.end() || !field.dimensions.empty()) {
      return std::nullopt;
    }
    if (field.type == "string") {
      if (!cursor.take(4, bits) || cursor.data.size() - cursor.at < bits) {
        return std::nullopt;
      }
      cursor.at += bits;
      continue;
    }
    if (!cursor.take(primitive->second, bits)) {
      return std::nullopt;
    }
    if (field.name == member && field.type != "double" && field.type != "float") {
      const std::size_t unused = 64 - 8 * primitive->second;
      return static_cast<std::int64_t>(bits << unused) >> unused;
    }
  }
  return std::nullopt;
}

}  // namespace luminav
