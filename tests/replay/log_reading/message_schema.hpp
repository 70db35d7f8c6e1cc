#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace luminav {

/// A member of a message type, as its .lcm file says.
struct FieldSchema {
  std::string name;
  std::string type;                     // "double", "int64_t", ..., or the name of another type
  std::vector<std::string> dimensions;  // each a number or the name of an earlier member; empty = a single value
  std::string unit;                     // from the comment's leading "[...]"; "" = none given
};

struct TypeSchema {
  std::string package;
  std::string name;
  std::vector<FieldSchema> fields;
  std::uint64_t fingerprint = 0;  // as lcm-gen computes it
};

/// A value of a decoded message with its path, such as "detections[2].x".
struct FieldValue {
  std::string path;
  std::string unit;
  std::variant<std::int64_t, double, std::string> value;
};

/// All message types, read from the text of the .lcm files: tools that show any message need no code per type.
class MessageSchemas {
 public:
  /// The types that this program was built with.
  static const MessageSchemas& built_in();
  /// Throws std::runtime_error for a text that is no LCM type.
  explicit MessageSchemas(const std::vector<std::string>& texts);

  /// nullptr for a fingerprint that no type has: another version of the type, or a foreign message.
  [[nodiscard]] const TypeSchema* find(std::uint64_t fingerprint) const;
  [[nodiscard]] const TypeSchema* find(std::string_view name) const;
  [[nodiscard]] const std::map<std::string, TypeSchema>& types() const { return types_; }

  /// All values of a message in the order of the type; byte arrays are left out, of other arrays only the first
  /// `longest` elements are given. Nothing when the bytes do not decode.
  [[nodiscard]] std::optional<std::vector<FieldValue>> decode(const std::vector<std::uint8_t>& data,
                                                              std::size_t longest = SIZE_MAX) const;
  /// One leading integer member (utime, session, sequence) without decoding the rest; nothing when the type has none
  /// or something of variable size stands before it.
  [[nodiscard]] std::optional<std::int64_t> integer(const std::vector<std::uint8_t>& data,
                                                    std::string_view member) const;

 private:
  struct Cursor;
  bool decode_fields(const TypeSchema& type, const std::string& prefix, Cursor& cursor) const;
  std::uint64_t hash(const TypeSchema& type, int depth) const;

  std::map<std::string, TypeSchema> types_;
  std::map<std::uint64_t, const TypeSchema*> by_fingerprint_;
};

}  // namespace luminav
