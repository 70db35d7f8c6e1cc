// What a stranger may put into a message of any type: the decoders must see it before they make room for it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <luminav_procman/procman_command_desired_t.hpp>
#include <luminav_procman/procman_command_status_t.hpp>
#include <luminav_procman/procman_command_t.hpp>
#include <luminav_procman/procman_deputy_info_t.hpp>
#include <luminav_procman/procman_discovery_t.hpp>
#include <luminav_procman/procman_orders_t.hpp>
#include <luminav_procman/procman_output_t.hpp>
#include <map>
#include <new>
#include <set>
#include <string>

#include "tests/fuzz/message_types.hpp"
#include "tests/replay/log_reading/sample_message.hpp"
#include "tests/support/largest_allocation.hpp"

namespace luminav {
namespace {

constexpr std::size_t kEnough = 64 * 1024;  // [bytes] for the few that each sample has

template <typename Message>
struct Decoding {
  /// Calls back with a decoder for each type.
  template <typename Visitor>
  static void visit(const Visitor& visitor) {
    visitor(Message::getTypeName(), [](const std::vector<std::uint8_t>& data) {
      Message message{};
      return message.decode(data.data(), 0, static_cast<int>(data.size()));
    });
  }
};

template <typename... Messages, typename Visitor>
void visit_types(MessageTypes<Messages...>, const Visitor& visitor) {
  (Decoding<Messages>::visit(visitor), ...);
}

template <typename Visitor>
void for_each_type(const Visitor& visitor) {
  visit_types(AllMessageTypes{}, visitor);
}

/// The members that count others.
std::set<std::string> counts_of(const MessageSchemas& schemas, const TypeSchema& type) {
  std::set<std::string> counts;
  for (const FieldSchema& field : type.fields) {
    for (const std::string& dimension : field.dimensions) {
      if (std::isdigit(static_cast<unsigned char>(dimension.front())) == 0) {
        counts.insert(dimension);
      }
    }
    if (const TypeSchema* nested = schemas.find(field.type)) {
      counts.merge(counts_of(schemas, *nested));
    }
  }
  return counts;
}

bool is_short(const TypeSchema& type, const std::string& name) {
  return std::any_of(type.fields.begin(), type.fields.end(),
                     [&](const FieldSchema& field) { return field.name == name && field.type == "int16_t"; });
}

TEST(HostileMessage, EveryTypeIsTried) {
  std::set<std::string> tried;
  for_each_type([&](const char* name, const auto&) { tried.insert(name); });
  for (const auto& [name, type] : MessageSchemas::built_in().types()) {
    EXPECT_TRUE(tried.contains(name)) << name;
  }
}

TEST(HostileMessage, NoCountMakesRoomForWhatIsNotThere) {
  const MessageSchemas& schemas = MessageSchemas::built_in();
  for_each_type([&](const char* name, const auto& decode) {
    const TypeSchema& type = *schemas.find(std::string_view(name));
    EXPECT_GT(decode(sample_message(schemas, type)), 0) << name;
    for (const std::string& count : counts_of(schemas, type)) {
      for (const std::int64_t value : {std::int64_t{-1}, std::int64_t{1} << 27, std::int64_t{1} << 29,
                                       (std::int64_t{1} << 30) - 1, (std::int64_t{1} << 31) - 1}) {
        if (is_short(type, count) && static_cast<std::int16_t>(value) == 0) {
          continue;  // on the wire it is none
        }
        const std::vector<std::uint8_t> data = sample_message(schemas, type, {{count, value}});
        testing::take_largest_allocation();
        EXPECT_LT(decode(data), 0) << name << "." << count << " = " << value;
        EXPECT_LE(testing::take_largest_allocation(), kEnough) << name << "." << count << " = " << value;
      }
    }
  });
}

TEST(HostileMessage, NeitherCutsNorAnyFourBytesMakeADecoderThrowOrAskForMuch) {
  const MessageSchemas& schemas = MessageSchemas::built_in();
  for_each_type([&](const char* name, const auto& decode) {
    const std::vector<std::uint8_t> whole = sample_message(schemas, *schemas.find(std::string_view(name)));
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const std::vector<std::uint8_t> cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_LT(decode(cut), 0) << name << " cut to " << size;
    }
    for (std::size_t at = 0; at + 4 <= whole.size(); ++at) {
      for (const unsigned fill : {0x00U, 0x20U, 0x3FU, 0x7FU, 0xFFU}) {
        std::vector<std::uint8_t> damaged = whole;
        std::fill_n(damaged.begin() + static_cast<std::ptrdiff_t>(at), 4, static_cast<std::uint8_t>(fill));
        testing::take_largest_allocation();
        EXPECT_NO_THROW(decode(damaged)) << name << " at " << at << ": " << fill;
        EXPECT_LE(testing::take_largest_allocation(), kEnough) << name << " at " << at << ": " << fill;
      }
    }
  });
}

TEST(HostileMessage, NoTextGoesOnBehindItsEndOrHasNone) {
  const MessageSchemas& schemas = MessageSchemas::built_in();
  const std::string text = "sample";  // as every text of a sample
  int texts = 0;
  for_each_type([&](const char* name, const auto& decode) {
    const std::vector<std::uint8_t> whole = sample_message(schemas, *schemas.find(std::string_view(name)));
    for (auto at = std::search(whole.begin(), whole.end(), text.begin(), text.end()); at != whole.end();
         at = std::search(at + 1, whole.end(), text.begin(), text.end())) {
      for (const std::ptrdiff_t place : {std::ptrdiff_t{2}, static_cast<std::ptrdiff_t>(text.size())}) {
        std::vector<std::uint8_t> damaged = whole;
        std::uint8_t& byte = damaged[static_cast<std::size_t>(at - whole.begin() + place)];
        byte = byte == 0 ? 'x' : 0;
        EXPECT_LT(decode(damaged), 0) << name << " at " << at - whole.begin() + place;
      }
      ++texts;
    }
  });
  EXPECT_GT(texts, 20);
}

TEST(HostileMessage, NoNumberIsInfiniteOrNone) {
  const MessageSchemas& schemas = MessageSchemas::built_in();
  // 0.5, as every number of a sample, in the bytes of each kind of number, and what it may not become
  const std::map<std::string, std::vector<std::uint8_t>> kHalf = {{"double", {0x3F, 0xE0, 0, 0, 0, 0, 0, 0}},
                                                                  {"float", {0x3F, 0, 0, 0}}};
  const std::map<std::string, std::vector<std::uint8_t>> kTops = {{"double", {0x7F, 0xF0}}, {"float", {0x7F, 0x80}}};
  int numbers = 0;
  for_each_type([&](const char* name, const auto& decode) {
    const std::vector<std::uint8_t> whole = sample_message(schemas, *schemas.find(std::string_view(name)));
    for (const auto& [kind, half] : kHalf) {
      for (auto at = std::search(whole.begin(), whole.end(), half.begin(), half.end()); at != whole.end();
           at = std::search(at + 1, whole.end(), half.begin(), half.end())) {
        for (const int sign : {0x00, 0x80}) {
          for (const std::uint8_t fraction : std::initializer_list<std::uint8_t>{0, 1}) {
            std::vector<std::uint8_t> damaged = whole;
            const auto begin = damaged.begin() + (at - whole.begin());
            begin[0] = static_cast<std::uint8_t>(kTops.at(kind)[0] | sign);
            begin[1] = kTops.at(kind)[1];
            begin[static_cast<std::ptrdiff_t>(half.size()) - 1] = fraction;
            EXPECT_LT(decode(damaged), 0) << name << ", the " << kind << " at " << at - whole.begin();
          }
        }
        ++numbers;
      }
    }
  });
  EXPECT_GT(numbers, 150);
}

TEST(HostileMessage, BytesAfterAMessageChangeNothing) {
  const MessageSchemas& schemas = MessageSchemas::built_in();
  for_each_type([&](const char* name, const auto& decode) {
    std::vector<std::uint8_t> data = sample_message(schemas, *schemas.find(std::string_view(name)));
    const auto size = static_cast<int>(data.size());
    data.insert(data.end(), 64, 0xA5);
    EXPECT_EQ(decode(data), size) << name;
    EXPECT_TRUE(schemas.decode(data).has_value()) << name;
  });
}

}  // namespace
}  // namespace luminav
