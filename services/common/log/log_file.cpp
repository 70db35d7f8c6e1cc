#include "services/common/log/log_file.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <filesystem>
#include <stdexcept>

namespace luminav {
namespace {

// An event: sync word, event number (8 bytes), time stamp (8), length of the channel's name (4), of the data (4), both;
// all numbers big-endian.
constexpr std::array<std::uint8_t, 4> kSync = {0xED, 0xA1, 0xDA, 0x01};
constexpr std::size_t kHeader = 24;                 // [bytes] behind the sync word
constexpr std::uint32_t kLongestChannel = 255;      // LCM allows 63; older tools wrote longer ones
constexpr std::uint32_t kLongestData = 256U << 20;  // LCM's own limit

template <typename Number>
Number big_endian(const std::uint8_t* bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    value = (value << 8) | bytes[i];
  }
  return static_cast<Number>(value);
}

template <typename Number>
void put_big_endian(std::string& out, Number number) {
  for (std::size_t i = sizeof(Number); i-- > 0;) {
    out.push_back(static_cast<char>((static_cast<std::uint64_t>(number) >> (8 * i)) & 0xFF));
  }
}

}  // namespace

std::uint64_t LogEvent::fingerprint() const {
  return data.size() < 8 ? 0 : big_endian<std::uint64_t>(data.data());
}

std::string log_event_head(std::int64_t number, std::int64_t utime, std::string_view channel, std::size_t size) {
  std::string head(reinterpret_cast<const char*>(kSync.data()), kSync.size());
  put_big_endian(head, number);
  put_big_endian(head, utime);
  put_big_endian(head, static_cast<std::uint32_t>(channel.size()));
  put_big_endian(head, static_cast<std::uint32_t>(size));
  head += channel;
  return head;
}

LogReader::LogReader(const std::string& file) : file_(file), stream_(file, std::ios::binary) {
  std::error_code error;
  if (!stream_ || std::filesystem::is_directory(file, error)) {
    throw std::runtime_error(fmt::format("{}: cannot be read", file));
  }
  size_ = std::filesystem::file_size(file, error);
  if (error || size_ == 0) {
    throw std::runtime_error(fmt::format("{}: the file is empty", file));
  }
  std::array<std::uint8_t, 4> first{};
  stream_.read(reinterpret_cast<char*>(first.data()), first.size());
  if (stream_.gcount() != 4 || first != kSync) {
    throw std::runtime_error(fmt::format("{}: not an LCM log (it does not begin with an event)", file));
  }
  stream_.seekg(0);
}

bool LogReader::read(std::uint8_t* target, std::size_t count) {
  stream_.read(reinterpret_cast<char*>(target), static_cast<std::streamsize>(count));
  return static_cast<std::size_t>(stream_.gcount()) == count;
}

bool LogReader::find_sync() {
  std::size_t matched = 0;
  std::uint64_t passed = 0;
  for (int byte = stream_.get(); byte != std::char_traits<char>::eof(); byte = stream_.get()) {
    ++passed;
    if (static_cast<std::uint8_t>(byte) == kSync[matched]) {
      ++matched;
    } else {
      matched = static_cast<std::uint8_t>(byte) == kSync[0] ? 1 : 0;
    }
    if (matched == kSync.size()) {
      skipped_ += passed - kSync.size();
      position_ += passed - kSync.size();
      return true;
    }
  }
  cut_ = passed > 0;
  return false;
}

bool LogReader::next(LogEvent& event) {
  while (find_sync()) {
    std::array<std::uint8_t, kHeader> header{};
    if (!read(header.data(), header.size())) {
      return end_cut();
    }
    const auto channel_size = big_endian<std::uint32_t>(&header[16]);
    const auto data_size = big_endian<std::uint32_t>(&header[20]);
    const std::uint64_t whole = kSync.size() + kHeader + channel_size + data_size;
    const bool is_plausible = channel_size > 0 && channel_size <= kLongestChannel && data_size <= kLongestData;
    if (!is_plausible || position_ + whole > size_) {
      if (is_plausible && !unfinished_) {
        unfinished_ = Place{position_, skipped_};
      }
      // not an event after all, the cut, or a damaged length: what is behind this sync word tells
      skipped_ += kSync.size();
      position_ += kSync.size();
      stream_.seekg(static_cast<std::streamoff>(position_));
      continue;
    }
    LogEvent read_event;
    read_event.utime = big_endian<std::int64_t>(&header[8]);
    read_event.channel.resize(channel_size);
    if (!read(reinterpret_cast<std::uint8_t*>(read_event.channel.data()), channel_size)) {
      return end_cut();
    }
    if (wanted_ && !wanted_->contains(read_event.channel)) {
      stream_.seekg(static_cast<std::streamoff>(data_size), std::ios::cur);
    } else {
      read_event.data.resize(data_size);
      if (!read(read_event.data.data(), data_size)) {
        return end_cut();
      }
    }
    unfinished_.reset();
    position_ += whole;
    ++events_;
    event = std::move(read_event);
    return true;
  }
  return unfinished_ ? end_cut() : false;
}

void LogReader::go_to(std::uint64_t position) {
  stream_.clear();  // it may have been at the end
  stream_.seekg(static_cast<std::streamoff>(position));
  position_ = position;
  unfinished_.reset();
}

bool LogReader::end_cut() {
  cut_ = true;
  if (unfinished_) {
    position_ = unfinished_->position;
    skipped_ = unfinished_->skipped;
  }
  return false;
}

std::string LogReader::damage() const {
  std::string text;
  if (skipped_ > 0) {
    text = fmt::format("{}: {} bytes between events are damaged and were passed over", file_, skipped_);
  }
  if (cut_) {
    text += fmt::format("{}{}: cut at byte {} of {}; the {} events before it were used", text.empty() ? "" : "; ",
                        text.empty() ? file_ : "it is", position_, size_, events_);
  }
  return text;
}

struct LogWriter::Digest {
  Digest() : context(EVP_MD_CTX_new()) {
    if (context == nullptr || EVP_DigestInit_ex(context, EVP_sha256(), nullptr) != 1) {
      throw std::runtime_error("SHA-256 is not available");
    }
  }
  ~Digest() { EVP_MD_CTX_free(context); }
  Digest(const Digest&) = delete;
  Digest& operator=(const Digest&) = delete;
  EVP_MD_CTX* context;
};

LogWriter::LogWriter(const std::string& file) : digest_(std::make_unique<Digest>()) {
  if (!file.empty()) {
    file_.emplace(file);
  }
}

LogWriter::~LogWriter() = default;

void LogWriter::put(const void* data, std::size_t size) {
  constexpr std::size_t kPiece = 65536;
  EVP_DigestUpdate(digest_->context, data, size);
  if (file_) {
    pending_.append(static_cast<const char*>(data), size);
    if (pending_.size() >= kPiece) {
      file_->write(pending_);
      pending_.clear();
    }
  }
}

void LogWriter::write(std::int64_t utime, std::string_view channel, const void* data, std::size_t size) {
  const std::string head = log_event_head(events_++, utime, channel, size);
  put(head.data(), head.size());
  put(data, size);
}

std::string LogWriter::finish() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  EVP_DigestFinal_ex(digest_->context, digest.data(), &size);
  if (file_) {
    file_->write(pending_);
    file_->finish();
  }
  std::string text;
  for (unsigned int i = 0; i < size; ++i) {
    text += fmt::format("{:02x}", digest[i]);
  }
  return text;
}

}  // namespace luminav
