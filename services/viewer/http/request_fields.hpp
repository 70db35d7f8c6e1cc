#pragma once

#include <cstdint>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "services/viewer/request_text.hpp"

namespace luminav {

// Parts of a request's JSON, read strictly: each throws RequestError for what is not there or not allowed.

/// The body, an object of no other keys than these.
nlohmann::json read_object(const std::string& body, std::initializer_list<std::string_view> known);
/// That an item of a list, or a part, is an object of no other keys than these; `list` names it.
void check_item(const nlohmann::json& item, const char* list, std::initializer_list<std::string_view> known);
double number(const nlohmann::json& object, const char* key, double min, double max);
std::int64_t integer(const nlohmann::json& object, const char* key, std::int64_t min, std::int64_t max);
bool boolean(const nlohmann::json& object, const char* key);
std::string text(const nlohmann::json& object, const char* key);
/// A text of a single line, which may end no line of a file; "" is one.
std::string line(const nlohmann::json& object, const char* key, std::size_t max_bytes);
/// The name of something, which people can read.
std::string name(const nlohmann::json& object, const char* key);
/// The value of a key that must be there.
const nlohmann::json& part(const nlohmann::json& object, const char* key);
/// The place of a word in a list, which is the number on the wire.
std::int8_t choice(const nlohmann::json& object, const char* key, std::initializer_list<std::string_view> words);

}  // namespace luminav
