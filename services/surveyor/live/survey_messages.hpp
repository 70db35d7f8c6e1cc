#pragma once

#include <cstdint>
#include <luminav/goal_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/survey_status_t.hpp>

#include "services/surveyor/explore/exploration.hpp"
#include "services/surveyor/live/live_survey.hpp"
#include "services/surveyor/survey/ceiling_kinds.hpp"

namespace luminav {

/// The growing map as a message that fits a datagram: of a long path every so manieth point, of too many fixtures,
/// places or remarks the first.
survey_status_t to_message(const LiveMap& map, const CeilingKinds& kinds);

/// A request of the exploration at a time [us].
goal_t to_message(const ExploreGoal& request, std::int64_t now);

/// What the exploration has to know of the planner; while a robot may not drive, its goal is paused.
GoalNews news_of(const navigation_status_t& message, bool may_drive);

}  // namespace luminav
