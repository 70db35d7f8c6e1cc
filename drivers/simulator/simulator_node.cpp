#include "drivers/simulator/simulator_node.hpp"

#include <luminav/sim_truth_t.hpp>

#include "drivers/simulator/world/lamp_state.hpp"
#include "services/common/process/channels.hpp"

namespace luminav {

static_assert(kLampOff == sim_truth_t::LAMP_OFF && kLampOn == sim_truth_t::LAMP_ON &&
              kLampHalf == sim_truth_t::LAMP_HALF && kLampFlicker == sim_truth_t::LAMP_FLICKER);

SimulatorNode::SimulatorNode(lcm::LCM& lcm, std::uint64_t seed, const WorldTruth& truth, BaseBoard& board)
    : lcm_(lcm), board_(board), world_(seed, truth), battery_(truth.battery_voltage) {}

void SimulatorNode::advance_to(std::int64_t utime) {
  if (session_ == 0) {
    session_ = now_ = utime;
    publish_truth();
  }
  while (now_ + kTick <= utime) {
    now_ += kTick;
    tick();
    publish_truth();
  }
}

void SimulatorNode::tick() {
  BoardInputs inputs;
  inputs.left_travel = wheels_.left;
  inputs.right_travel = wheels_.right;
  inputs.stall_left = inputs.stall_right = wheels_.stalled;
  inputs.bumpers_front = wheels_.bumpers;
  inputs.cliffs = wheels_.cliffs;
  inputs.wheel_drop_left = wheels_.drop_left;
  inputs.wheel_drop_right = wheels_.drop_right;
  inputs.battery_voltage = battery_.voltage();
  inputs.charge_state = battery_.charge_state();
  const BoardOutputs outputs = board_.step(World::kTick, inputs);
  battery_.step(World::kTick, outputs.motors_enabled, outputs.linear, outputs.angular, world_.is_on_charger());
  wheels_ = world_.step({outputs.linear, outputs.angular, outputs.motors_enabled});
  for (const int disc : outputs.sonar_discs) {
    if (disc < world_.sonar_discs()) {
      board_.set_sonar_reading(disc, world_.measure_sonar(disc));
    }
  }
}

void SimulatorNode::publish_truth() {
  const WorldState& state = world_.state();
  sim_truth_t truth{};
  truth.utime = now_;
  truth.session = session_;
  truth.sequence = sequence_++;
  truth.x = state.world_from_robot.x;
  truth.y = state.world_from_robot.y;
  truth.theta = state.world_from_robot.theta;
  truth.roll = state.roll;
  truth.pitch = state.pitch;
  truth.linear = state.linear;
  truth.angular = state.angular;
  truth.carried = state.carried ? 1 : 0;
  truth.carries = state.carries;
  truth.touching = world_.contacts().touching() ? 1 : 0;
  truth.contacts = world_.contacts().contacts();
  truth.hard_contacts = world_.contacts().hard_contacts();
  truth.clearance = state.clearance;
  truth.daylight = state.daylight;
  truth.camera_unplugged = state.camera_unplugged ? 1 : 0;
  truth.serial_unplugged = state.serial_unplugged ? 1 : 0;
  for (const Disc& person : world_.people()) {
    truth.person_x.push_back(static_cast<float>(person.centre.x()));
    truth.person_y.push_back(static_cast<float>(person.centre.y()));
  }
  truth.people = static_cast<std::int32_t>(truth.person_x.size());
  truth.lamp_state = state.lamp_states;
  truth.lamps = static_cast<std::int32_t>(truth.lamp_state.size());
  for (const auto& [index, offset] : state.lamp_offsets) {
    truth.moved_index.push_back(index);
    truth.moved_dx.push_back(static_cast<float>(offset.x));
    truth.moved_dy.push_back(static_cast<float>(offset.y));
    truth.moved_dtheta.push_back(static_cast<float>(offset.theta));
  }
  truth.moved_lamps = static_cast<std::int32_t>(truth.moved_index.size());
  for (const bool open : state.door_open) {
    truth.door_open.push_back(open ? 1 : 0);
  }
  truth.doors = static_cast<std::int32_t>(truth.door_open.size());
  lcm_.publish(channels::kSimTruth, &truth);
}

}  // namespace luminav
