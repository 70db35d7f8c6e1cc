#include "drivers/camera/truth_message.hpp"

namespace luminav {

static_assert(static_cast<int>(simulated::LampState::kOff) == sim_truth_t::LAMP_OFF &&
              static_cast<int>(simulated::LampState::kOn) == sim_truth_t::LAMP_ON &&
              static_cast<int>(simulated::LampState::kHalf) == sim_truth_t::LAMP_HALF &&
              static_cast<int>(simulated::LampState::kFlicker) == sim_truth_t::LAMP_FLICKER);

simulated::TruthSample truth_sample(const sim_truth_t& message) {
  simulated::TruthSample sample;
  sample.utime = message.utime;
  sample.session = message.session;
  sample.world_from_robot = {message.x, message.y, message.theta};
  sample.roll = message.roll;
  sample.pitch = message.pitch;
  sample.camera_unplugged = message.camera_unplugged != 0;
  sample.daylight = message.daylight;
  for (const std::int8_t state : message.lamp_state) {
    sample.lamps.push_back(static_cast<simulated::LampState>(state));
  }
  for (std::size_t i = 0; i < message.moved_index.size(); ++i) {
    sample.moved.push_back({message.moved_index[i], message.moved_dx[i], message.moved_dy[i], message.moved_dtheta[i]});
  }
  return sample;
}

}  // namespace luminav
