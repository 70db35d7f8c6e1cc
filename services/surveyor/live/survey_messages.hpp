#pragma once

#include <luminav/survey_status_t.hpp>

#include "services/surveyor/live/live_survey.hpp"
#include "services/surveyor/survey/ceiling_kinds.hpp"

namespace luminav {

/// The growing map as a message that fits a datagram: of a long path every so manieth point, of too many fixtures,
/// places or remarks the first.
survey_status_t to_message(const LiveMap& map, const CeilingKinds& kinds);

}  // namespace luminav
