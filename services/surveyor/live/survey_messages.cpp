#include "services/surveyor/live/survey_messages.hpp"

#include <algorithm>
#include <luminav/fixture_detection_t.hpp>

namespace luminav {
namespace {

constexpr std::size_t kLongestRemark = 300;  // [bytes]

std::int8_t shape_of(FixtureShape shape) {
  return shape == FixtureShape::kSquare  ? fixture_detection_t::SHAPE_SQUARE
         : shape == FixtureShape::kRound ? fixture_detection_t::SHAPE_ROUND
                                         : fixture_detection_t::SHAPE_RECTANGLE;
}

surveyed_fixture_t to_message(const LiveFixture& fixture, const Fixture& kind) {
  surveyed_fixture_t message{};
  message.shape = shape_of(kind.shape);
  message.length = static_cast<float>(kind.length);
  message.width = static_cast<float>(kind.width);
  message.x = fixture.world_from_fixture.x;
  message.y = fixture.world_from_fixture.y;
  message.theta = fixture.world_from_fixture.theta;
  message.covariance[0] = static_cast<float>(fixture.covariance(0, 0));
  message.covariance[1] = static_cast<float>(fixture.covariance(0, 1));
  message.covariance[2] = static_cast<float>(fixture.covariance(1, 1));
  message.is_provisional = fixture.is_provisional;
  message.is_open = fixture.is_open;
  return message;
}

std::size_t at_most(std::int32_t limit, std::size_t count) {
  return std::min(static_cast<std::size_t>(limit), count);
}

void add_path(const LiveMap& map, survey_status_t& message) {
  const std::size_t step = map.path.size() / static_cast<std::size_t>(survey_status_t::MAX_PATH) + 1;
  for (std::size_t i = 0; i < map.path.size(); i += step) {
    message.path_x.push_back(static_cast<float>(map.path[i].x()));
    message.path_y.push_back(static_cast<float>(map.path[i].y()));
  }
  message.path_count = static_cast<std::int32_t>(message.path_x.size());
}

}  // namespace

survey_status_t to_message(const LiveMap& map, const CeilingKinds& kinds) {
  survey_status_t message{};
  message.distance = map.distance;
  message.estimated_distance = map.estimated_distance;
  message.has_pose = map.world_from_robot.has_value();
  const Pose2 pose = map.world_from_robot.value_or(Pose2{});
  message.x = pose.x;
  message.y = pose.y;
  message.theta = pose.theta;
  for (std::size_t i = 0; i < at_most(survey_status_t::MAX_FIXTURES, map.fixtures.size()); ++i) {
    const LiveFixture& fixture = map.fixtures[i];
    message.fixtures.push_back(to_message(fixture, kinds.kinds[static_cast<std::size_t>(fixture.kind)]));
  }
  message.fixture_count = static_cast<std::int32_t>(message.fixtures.size());
  add_path(map, message);
  for (std::size_t i = 0; i < at_most(survey_status_t::MAX_PLACES, map.places.size()); ++i) {
    message.place_names.push_back(map.places[i].name);
    message.place_x.push_back(static_cast<float>(map.places[i].position.x()));
    message.place_y.push_back(static_cast<float>(map.places[i].position.y()));
  }
  message.place_count = static_cast<std::int32_t>(message.place_names.size());
  for (std::size_t i = 0; i < at_most(survey_status_t::MAX_REMARKS, map.remarks.size()); ++i) {
    message.remarks.push_back(map.remarks[i].substr(0, kLongestRemark));
  }
  message.remark_count = static_cast<std::int32_t>(message.remarks.size());
  return message;
}

goal_t to_message(const ExploreGoal& request, std::int64_t now) {
  goal_t goal{};
  goal.utime = now;
  goal.id = request.id;
  goal.policy = goal_t::POLICY_STOP;
  if (request.is_cancel) {
    goal.action = goal_t::ACTION_CANCEL;
    return goal;
  }
  goal.action = goal_t::ACTION_GO;
  goal.count = 1;
  goal_pose_t pose{};
  pose.x = request.position.x();
  pose.y = request.position.y();
  goal.poses.push_back(pose);
  return goal;
}

GoalNews news_of(const navigation_status_t& message, bool may_drive) {
  GoalNews news;
  news.goal_id = message.goal_id;
  news.is_over =
      message.state >= navigation_status_t::STATE_ARRIVED && message.state <= navigation_status_t::STATE_LOST;
  news.has_arrived = message.state == navigation_status_t::STATE_ARRIVED;
  news.is_paused = message.state == navigation_status_t::STATE_PAUSED || !may_drive;
  if (message.has_target != 0) {
    news.target = Eigen::Vector2d(message.x, message.y);
  }
  news.cause = message.cause;
  return news;
}

}  // namespace luminav
