#include "services/viewer/http/readings.hpp"

#include <fmt/format.h>

#include <utility>

#include "services/viewer/message_json.hpp"

namespace luminav {
namespace {

constexpr const char* kNothingYet = "nothing of this was heard yet";

/// All tiles of the map in one text. It is kept for a second: a large one has megabytes, and readers share them.
class MapReading {
 public:
  MapReading(const SnapshotBoard& board, const Clock& clock) : board_(board), clock_(clock) {}

  HttpResponse operator()(const HttpRequest& /*request*/) {
    constexpr std::int64_t kKept = 1'000'000;  // [us]
    const std::int64_t now = clock_.utime();
    if (!response_.body || now < made_ || now - made_ >= kKept) {
      response_ = text_answer(tiles_json());
      made_ = now;
    }
    return response_;
  }

 private:
  [[nodiscard]] std::string tiles_json() const {
    std::string tiles;
    for (const SnapshotBoard::Text& text : board_.all(SnapshotBoard::Lane::kBulk)) {
      tiles += (tiles.empty() ? "" : ",") + json_of(*text);
    }
    return fmt::format(R"({{"tiles":[{}]}})", tiles);
  }

  const SnapshotBoard& board_;
  const Clock& clock_;
  HttpResponse response_;
  std::int64_t made_ = 0;  // [us]
};

}  // namespace

HttpResponse text_answer(std::string text, std::string_view type) {
  HttpResponse response;
  response.type = type;
  response.body = std::make_shared<const std::string>(std::move(text));
  return response;
}

HttpResponse refusal(int status, std::string_view why) {
  HttpResponse response = text_answer(fmt::format(R"({{"error":{}}})", to_json(why)));
  response.status = status;
  return response;
}

Readings board_readings(const SnapshotBoard& board, const Clock& clock, BuildingNow building) {
  Readings readings;
  for (const char* subject :
       {"state", "nodes", "processes", "path", "hypotheses", "jobs", "survey", "building", "tours"}) {
    readings[fmt::format("/api/{}", subject)] = [&board, subject](const HttpRequest&) {
      const SnapshotBoard::Text text = board.newest(SnapshotBoard::Lane::kLive, subject);
      return text ? text_answer(json_of(*text)) : refusal(404, kNothingYet);
    };
  }
  readings["/api/places"] = [building = std::move(building)](const HttpRequest&) {
    return text_answer(fmt::format(R"({{"places":{}}})", places_json(*building())));
  };
  readings["/api/map"] = MapReading(board, clock);
  readings["/metrics"] = [&board](const HttpRequest&) {
    const SnapshotBoard::Text text = board.newest(SnapshotBoard::Lane::kAsked, "metrics");
    return text ? text_answer(*text, "text/plain; version=0.0.4; charset=utf-8") : refusal(404, kNothingYet);
  };
  return readings;
}

}  // namespace luminav
