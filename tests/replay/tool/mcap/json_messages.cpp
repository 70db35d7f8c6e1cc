#include "tests/replay/tool/mcap/json_messages.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace luminav {
namespace {

using Json = nlohmann::json;

/// "detections[2].corners_px[0]" as "/detections/2/corners_px/0".
Json::json_pointer pointer(const std::string& path) {
  std::string result = "/";
  for (const char letter : path) {
    if (letter != ']') {
      result += letter == '[' || letter == '.' ? '/' : letter;
    }
  }
  return Json::json_pointer(result);
}

Json value_json(const FieldValue& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value.value)) {
    return *integer;
  }
  if (const auto* number = std::get_if<double>(&value.value)) {
    return std::isfinite(*number) ? Json(*number) : Json(nullptr);
  }
  return std::get<std::string>(value.value);
}

Json fields_schema(const MessageSchemas& schemas, const TypeSchema& type);

Json field_schema(const MessageSchemas& schemas, const FieldSchema& field) {
  if (const TypeSchema* inner = schemas.find(std::string_view(field.type))) {
    return fields_schema(schemas, *inner);
  }
  if (field.type == "string") {
    return {{"type", "string"}};
  }
  return {{"type", field.type == "double" || field.type == "float" ? "number" : "integer"}};
}

Json fields_schema(const MessageSchemas& schemas, const TypeSchema& type) {
  Json properties = Json::object();
  for (const FieldSchema& field : type.fields) {
    if (field.type == "byte" && !field.dimensions.empty()) {
      continue;
    }
    Json schema = field_schema(schemas, field);
    for (std::size_t i = 0; i < field.dimensions.size(); ++i) {
      schema = {{"type", "array"}, {"items", schema}};
    }
    if (!field.unit.empty()) {
      schema["description"] = fmt::format("[{}]", field.unit);
    }
    properties[field.name] = schema;
  }
  return {{"type", "object"}, {"properties", properties}};
}

}  // namespace

std::optional<std::string> message_json(const MessageSchemas& schemas, const std::vector<std::uint8_t>& data,
                                        std::size_t longest) {
  const std::optional<std::vector<FieldValue>> values = schemas.decode(data, longest);
  if (!values) {
    return std::nullopt;
  }
  Json json = Json::object();
  for (const FieldValue& value : *values) {
    json[pointer(value.path)] = value_json(value);
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string json_schema(const MessageSchemas& schemas, const TypeSchema& type) {
  Json schema = fields_schema(schemas, type);
  schema["title"] = fmt::format("{}.{}", type.package, type.name);
  return schema.dump();
}

}  // namespace luminav
