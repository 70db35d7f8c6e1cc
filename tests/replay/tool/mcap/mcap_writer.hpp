#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "services/common/configuration/whole_file.hpp"
#include "tests/replay/tool/mcap/message_sink.hpp"

namespace luminav {

/// Writes an MCAP file of JSON messages: chunks of a megabyte, uncompressed, with checksums and an index, so that
/// viewers seek in it. Format: https://mcap.dev/spec, version 0. The file is there when `finish` has returned; a writer
/// that is destroyed before leaves nothing. Throws std::runtime_error when it cannot be written.
class McapWriter : public MessageSink {
 public:
  explicit McapWriter(const std::string& file);

  Channel add_channel(const std::string& topic, const std::string& schema_name, const std::string& schema) override;
  void write(Channel channel, std::uint64_t log_time, std::uint64_t publish_time, std::string_view json) override;
  void finish();

 private:
  /// Earliest and latest time [ns]; 0 while there is none.
  struct Span {
    std::uint64_t first = 0;
    std::uint64_t last = 0;
    void include(std::uint64_t time);
  };
  using Index =
      std::map<Channel, std::vector<std::pair<std::uint64_t, std::uint64_t>>>;  // time and offset in the chunk

  void put(const std::string& bytes);
  void end_chunk();

  WholeFile file_;
  std::uint64_t position_ = 0;  // [bytes] written
  std::map<std::string, std::uint16_t> schema_ids_;
  std::string schema_records_;
  std::string channel_records_;
  std::string chunk_;
  Span chunk_span_;
  Index chunk_index_;
  std::string chunk_indexes_;  // records for the summary
  std::uint32_t chunks_ = 0;
  std::map<Channel, std::uint64_t> counts_;
  Span span_;
};

}  // namespace luminav
