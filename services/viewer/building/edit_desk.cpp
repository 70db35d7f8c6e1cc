#include "services/viewer/building/edit_desk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include "services/viewer/message_json.hpp"
#include "services/viewer/request_text.hpp"

namespace luminav {
namespace {

constexpr std::size_t kMaxPending = 8;
constexpr std::size_t kMaxOutcomes = 2 * kMaxPending;  // each is looked at before it is forgotten

std::string json_list(const std::vector<std::string>& texts) {
  std::string list;
  for (const std::string& text : texts) {
    list += (list.empty() ? "" : ",") + to_json(std::string_view(text));
  }
  return "[" + list + "]";
}

}  // namespace

template <typename Changes>
EditDesk<Changes>::EditDesk(Changes changes) : changes_(std::move(changes)) {
  read_again();
  thread_ = std::thread([this] { work(); });
}

template <typename Changes>
EditDesk<Changes>::~EditDesk() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  has_work_.notify_one();
  thread_.join();
}

template <typename Changes>
auto EditDesk<Changes>::contents() const -> std::shared_ptr<const Contents> {
  const std::lock_guard lock(mutex_);
  return contents_;
}

template <typename Changes>
std::int64_t EditDesk<Changes>::order(Order order, std::int64_t now) {
  const std::lock_guard lock(mutex_);
  if (!objection_.empty()) {
    throw RequestError(objection_);
  }
  if (order.version != version_) {
    throw StaleVersion(Changes::kStale);
  }
  if (pending_.size() >= kMaxPending) {
    throw RequestError("too many edits are waiting");
  }
  last_id_ = std::max(now, last_id_ + 1);
  pending_.push_back({std::move(order), last_id_});
  has_work_.notify_one();
  return last_id_;
}

template <typename Changes>
void EditDesk<Changes>::object(std::string why) {
  const std::lock_guard lock(mutex_);
  objection_ = std::move(why);
}

template <typename Changes>
void EditDesk<Changes>::read_again() {
  const std::lock_guard reading(reading_);
  const FileVersions& versions = changes_.versions();
  std::string text;
  try {
    text = changes_.text();
  } catch (const std::runtime_error&) {
    return;  // what was read before is shown on, and each edit says what is wrong
  }
  std::optional<Contents> contents = changes_.read();
  std::string undo = versions.newest_before().filename().string();
  const std::lock_guard lock(mutex_);
  if (contents) {
    contents_ = std::make_shared<const Contents>(std::move(*contents));
    version_ = version_of(text);
    undo_ = std::move(undo);
  }
}

template <typename Changes>
void EditDesk<Changes>::look() {
  const auto stamp = changes_.versions().stamp();
  {
    const std::lock_guard lock(mutex_);
    if (stamp == stamp_) {
      return;
    }
    stamp_ = stamp;
  }
  read_again();
}

template <typename Changes>
bool EditDesk<Changes>::take_news() {
  const std::lock_guard lock(mutex_);
  return std::exchange(has_news_, false);
}

template <typename Changes>
void EditDesk<Changes>::work() {
  for (;;) {
    Pending next;
    {
      std::unique_lock lock(mutex_);
      has_work_.wait(lock, [this] { return is_ending_ || !pending_.empty(); });
      if (is_ending_) {
        return;
      }
      next = pending_.front();
      outcomes_.push_back({next.id, {}});
      if (outcomes_.size() > kMaxOutcomes) {
        outcomes_.pop_front();
      }
    }
    EditOutcome what = changes_.carry_out(next.order, next.id);
    read_again();
    const std::lock_guard lock(mutex_);
    pending_.pop_front();
    has_news_ = has_news_ || what.fate == EditOutcome::Fate::kDone;
    outcomes_.back().what = std::move(what);
  }
}

template <typename Changes>
std::string EditDesk<Changes>::json(const LocalTime& now) const {
  const std::lock_guard lock(mutex_);
  std::string orders;
  for (const Outcome& outcome : outcomes_) {
    orders += fmt::format(R"({}{{"id":{},"fate":"{}","said":{},"found":{}}})", orders.empty() ? "" : ",", outcome.id,
                          name_of(outcome.what.fate), to_json(std::string_view(outcome.what.said)),
                          json_list(outcome.what.found));
  }
  return fmt::format(R"({{"version":"{}",{},"undo":{},"objection":{},"orders":[{}]}})", version_,
                     Changes::members_of(*contents_, now), undo_.empty() ? "null" : to_json(std::string_view(undo_)),
                     to_json(std::string_view(objection_)), orders);
}

template class EditDesk<BuildingChanges>;
template class EditDesk<TourChanges>;

}  // namespace luminav
