#include "services/viewer/playback/log_view.hpp"

namespace luminav {

LogView::LogView(const std::string& log, const ViewerConfig& config, SnapshotBoard& board, PictureStore& pictures)
    : config_(config),
      board_(board),
      pictures_(pictures),
      player_(log),
      desk_(lcm_, "viewer"),
      helm_(lcm_, config.robot.limits) {
  clock_.set(player_.index().begin());
  start_anew();
}

void LogView::start_anew() {
  node_.emplace(lcm_, config_, clock_, board_, pictures_, desk_, helm_);
  metrics_.emplace(lcm_);
  board_.clear(SnapshotBoard::Lane::kLive);
  board_.clear(SnapshotBoard::Lane::kBulk);
  // A subject of its own, which is not renewed: readers hear of the jump before what comes after it.
  board_.put(SnapshotBoard::Lane::kLive, "jump", server_sent_event("playback", player_.state_json()));
}

void LogView::feed(const LogEvent& event, std::int64_t at) {
  clock_.set(player_.index().begin() + at);
  lcm_.publish(event.channel, event.data.data(), static_cast<unsigned int>(event.data.size()));
  while (lcm_.handleTimeout(0) > 0) {
  }
}

void LogView::advance(std::int64_t elapsed) {
  player_.advance(elapsed, {.start_anew = [this] { start_anew(); },
                            .feed = [this](const LogEvent& event, std::int64_t at) { feed(event, at); }});
  clock_.set(player_.index().begin() + player_.position());
  board_.put(SnapshotBoard::Lane::kLive, "playback", server_sent_event("playback", player_.state_json()));
  node_->show();
}

void LogView::show_processes() {
  node_->show_processes();
  board_.put(SnapshotBoard::Lane::kAsked, "metrics", metrics_->text(clock_.utime()));
}

}  // namespace luminav
