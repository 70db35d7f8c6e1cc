#pragma once

namespace luminav {

/// For what stops a robot: before all others for the processor, last to go when memory runs out. Takes what this user
/// may have (LimitRTPRIO=, OOMScoreAdjust= of the service) and nothing where that is nothing. Children inherit it.
void claim_urgency();

}  // namespace luminav
