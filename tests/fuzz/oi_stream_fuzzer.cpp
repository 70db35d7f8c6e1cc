#include <algorithm>
#include <cstdlib>

#include "drivers/create2/oi/sensor_reading.hpp"
#include "drivers/create2/oi/stream_parser.hpp"
#include "drivers/simulator/create2/create2_board.hpp"

using namespace luminav;

namespace {

void require(bool claim) {
  if (!claim) {
    std::abort();
  }
}

/// What a parser finds in a stream that comes in pieces of this size.
std::vector<std::vector<std::uint8_t>> find_payloads(std::span<const std::uint8_t> stream, std::size_t piece,
                                                     std::size_t length) {
  StreamParser parser;
  std::vector<std::vector<std::uint8_t>> payloads;
  for (std::size_t i = 0; i < stream.size(); i += piece) {
    parser.push(stream.subspan(i, std::min(piece, stream.size() - i)));
    while (auto payload = parser.next(length)) {
      payloads.push_back(std::move(*payload));
    }
  }
  return payloads;
}

}  // namespace

/// Whatever comes, in whatever pieces: the same frames, what decodes is what was sent, and a simulated robot that hears
/// it all stays below its top speed.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span stream(data, size);
  for (const std::size_t length : {std::size_t{3}, readings_size()}) {
    const auto whole = find_payloads(stream, std::max<std::size_t>(size, 1), length);
    require(whole == find_payloads(stream, 1, length));
    require(whole == find_payloads(stream, 7, length));
  }
  if (size >= readings_size()) {
    const auto payload = stream.first(readings_size());
    if (const auto reading = decode_readings(payload)) {
      require(decode_readings(encode_readings(*reading, wanted_readings())).has_value());
    }
  }
  Create2Board board(0.235);
  board.receive(stream);
  const BoardOutputs outputs = board.step(0.01, {});
  require(std::abs(outputs.linear) <= 0.5 + 1e-9);
  return 0;
}
