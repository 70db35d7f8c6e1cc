#include "tests/replay/tool/mcap/mcap_writer.hpp"

#include <zlib.h>

#include <algorithm>

namespace luminav {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kChunkSize = 1 << 20;  // [bytes]

enum class Op : char {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kStatistics = 11,
  kDataEnd = 15
};

/// Little-endian, as the format wants it, on any machine.
template <typename Integer>
std::string number(Integer value) {
  std::string bytes;
  for (std::size_t i = 0; i < sizeof(Integer); ++i) {
    bytes += static_cast<char>((static_cast<std::uint64_t>(value) >> (8 * i)) & 0xffU);
  }
  return bytes;
}

std::string text(std::string_view content) {
  return number(static_cast<std::uint32_t>(content.size())) + std::string(content);
}

std::string record(Op op, std::string_view content) {
  return static_cast<char>(op) + number(static_cast<std::uint64_t>(content.size())) + std::string(content);
}

std::uint32_t checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

}  // namespace

void McapWriter::Span::include(std::uint64_t time) {
  first = first == 0 ? time : std::min(first, time);
  last = std::max(last, time);
}

McapWriter::McapWriter(const std::string& file) : file_(file) {
  put(std::string(kMagic) + record(Op::kHeader, text("") + text("luminav")));
}

void McapWriter::put(const std::string& bytes) {
  file_.write(bytes);
  position_ += bytes.size();
}

McapWriter::Channel McapWriter::add_channel(const std::string& topic, const std::string& schema_name,
                                            const std::string& schema) {
  const auto [known, is_new] = schema_ids_.try_emplace(schema_name, static_cast<std::uint16_t>(schema_ids_.size() + 1));
  if (is_new) {
    const std::string bytes =
        record(Op::kSchema, number(known->second) + text(schema_name) + text("jsonschema") + text(schema));
    schema_records_ += bytes;
    chunk_ += bytes;
  }
  const auto channel = static_cast<Channel>(counts_.size());
  const std::string bytes =
      record(Op::kChannel, number(channel) + number(known->second) + text(topic) + text("json") + text(""));
  channel_records_ += bytes;
  chunk_ += bytes;
  counts_[channel] = 0;
  return channel;
}

void McapWriter::write(Channel channel, std::uint64_t log_time, std::uint64_t publish_time, std::string_view json) {
  chunk_index_[channel].emplace_back(log_time, chunk_.size());
  const auto sequence = static_cast<std::uint32_t>(++counts_.at(channel));
  std::string content = number(channel) + number(sequence) + number(log_time) + number(publish_time);
  content += json;
  chunk_ += record(Op::kMessage, content);
  chunk_span_.include(log_time);
  span_.include(log_time);
  if (chunk_.size() > kChunkSize) {
    end_chunk();
  }
}

void McapWriter::end_chunk() {
  const std::uint64_t begin = position_;
  const std::string span = number(chunk_span_.first) + number(chunk_span_.last);
  const auto size = static_cast<std::uint64_t>(chunk_.size());
  put(record(Op::kChunk, span + number(size) + number(checksum(chunk_)) + text("") + number(size) + chunk_));
  const std::uint64_t length = position_ - begin;
  const std::uint64_t indexes_begin = position_;
  std::string offsets;
  for (const auto& [channel, entries] : chunk_index_) {
    offsets += number(channel) + number(position_);
    std::string times;
    for (const auto& [time, offset] : entries) {
      times += number(time) + number(offset);
    }
    put(record(Op::kMessageIndex, number(channel) + text(times)));
  }
  chunk_indexes_ +=
      record(Op::kChunkIndex, span + number(begin) + number(length) + text(offsets) +
                                  number(position_ - indexes_begin) + text("") + number(size) + number(size));
  ++chunks_;
  chunk_.clear();
  chunk_index_.clear();
  chunk_span_ = {};
}

void McapWriter::finish() {
  if (!chunk_.empty()) {
    end_chunk();
  }
  put(record(Op::kDataEnd, number(std::uint32_t{0})));
  const std::uint64_t summary = position_;
  std::uint64_t messages = 0;
  std::string counts;
  for (const auto& [channel, count] : counts_) {
    messages += count;
    counts += number(channel) + number(count);
  }
  const std::string statistics = number(messages) + number(static_cast<std::uint16_t>(schema_ids_.size())) +
                                 number(static_cast<std::uint32_t>(counts_.size())) + number(std::uint32_t{0}) +
                                 number(std::uint32_t{0}) + number(chunks_) + number(span_.first) + number(span_.last) +
                                 text(counts);
  std::string bytes = schema_records_ + channel_records_ + record(Op::kStatistics, statistics) + chunk_indexes_;
  // the footer's checksum covers the summary and the footer up to itself
  bytes += static_cast<char>(Op::kFooter) + number(std::uint64_t{20}) + number(summary) + number(std::uint64_t{0});
  put(bytes + number(checksum(bytes)) + std::string(kMagic));
  file_.finish();
}

}  // namespace luminav
