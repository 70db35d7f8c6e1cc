#pragma once

#include <luminav/camera_image_t.hpp>
#include <luminav/control_status_t.hpp>
#include <luminav/fixture_detection_t.hpp>
#include <luminav/fixture_detections_t.hpp>
#include <luminav/goal_pose_t.hpp>
#include <luminav/goal_t.hpp>
#include <luminav/grid_tile_t.hpp>
#include <luminav/hypotheses_t.hpp>
#include <luminav/initial_pose_t.hpp>
#include <luminav/job_state_t.hpp>
#include <luminav/job_status_t.hpp>
#include <luminav/job_stop_t.hpp>
#include <luminav/job_t.hpp>
#include <luminav/map_command_t.hpp>
#include <luminav/motors_command_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/node_status_t.hpp>
#include <luminav/odometry_t.hpp>
#include <luminav/path_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/sim_truth_t.hpp>
#include <luminav/sonar_t.hpp>
#include <luminav/speed_limit_t.hpp>
#include <luminav/stop_t.hpp>
#include <luminav/supervision_t.hpp>
#include <luminav/survey_command_t.hpp>
#include <luminav/survey_status_t.hpp>
#include <luminav/surveyed_fixture_t.hpp>
#include <luminav/teleop_command_t.hpp>
#include <luminav/tile_request_t.hpp>
#include <luminav/velocity_command_t.hpp>
#include <luminav_procman/procman_command_desired_t.hpp>
#include <luminav_procman/procman_command_status_t.hpp>
#include <luminav_procman/procman_command_t.hpp>
#include <luminav_procman/procman_deputy_info_t.hpp>
#include <luminav_procman/procman_discovery_t.hpp>
#include <luminav_procman/procman_orders_t.hpp>
#include <luminav_procman/procman_output_t.hpp>

namespace luminav {

template <typename... Messages>
struct MessageTypes {};

/// All of lcmtypes/; tests/replay/hostile_message_test.cpp says when one is missing.
using AllMessageTypes = MessageTypes<
    camera_image_t, control_status_t, fixture_detection_t, fixture_detections_t, goal_pose_t, goal_t, grid_tile_t,
    hypotheses_t, initial_pose_t, job_state_t, job_status_t, job_stop_t, job_t, map_command_t, motors_command_t,
    navigation_status_t, node_status_t, odometry_t, path_t, pose_t, luminav_procman::procman_command_desired_t,
    luminav_procman::procman_command_status_t, luminav_procman::procman_command_t,
    luminav_procman::procman_deputy_info_t, luminav_procman::procman_discovery_t, luminav_procman::procman_orders_t,
    luminav_procman::procman_output_t, robot_status_t, sim_truth_t, sonar_t, speed_limit_t, stop_t, supervision_t,
    survey_command_t, survey_status_t, surveyed_fixture_t, teleop_command_t, tile_request_t, velocity_command_t>;

}  // namespace luminav
