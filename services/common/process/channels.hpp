#pragma once

namespace luminav::channels {

// Spelled once; the table in lcmtypes/README.md says type, rate and who sends what.
inline constexpr const char* kOdometry = "ODOMETRY";
inline constexpr const char* kSonar = "SONAR";
inline constexpr const char* kRobotStatus = "ROBOT_STATUS";
inline constexpr const char* kVelocityCommand = "VELOCITY_COMMAND";
inline constexpr const char* kCameraImage = "CAMERA_IMAGE";
inline constexpr const char* kFixtureDetections = "FIXTURE_DETECTIONS";
inline constexpr const char* kPose = "POSE";
inline constexpr const char* kHypotheses = "HYPOTHESES";
inline constexpr const char* kGridTile = "GRID_TILE";
inline constexpr const char* kTileRequest = "TILE_REQUEST";
inline constexpr const char* kMapCommand = "MAP_COMMAND";
inline constexpr const char* kGoal = "GOAL";
inline constexpr const char* kPath = "PATH";
inline constexpr const char* kNavigationStatus = "NAVIGATION_STATUS";
inline constexpr const char* kControlStatus = "CONTROL_STATUS";
inline constexpr const char* kStop = "STOP";
inline constexpr const char* kSupervision = "SUPERVISION";
inline constexpr const char* kMotorsCommand = "MOTORS_COMMAND";
inline constexpr const char* kTeleopCommand = "TELEOP_COMMAND";
inline constexpr const char* kSpeedLimit = "SPEED_LIMIT";
inline constexpr const char* kInitialPose = "INITIAL_POSE";
inline constexpr const char* kJob = "JOB";
inline constexpr const char* kJobStatus = "JOB_STATUS";
inline constexpr const char* kSurveyCommand = "SURVEY_COMMAND";
inline constexpr const char* kSurveyStatus = "SURVEY_STATUS";
inline constexpr const char* kNodeStatus = "NODE_STATUS";
inline constexpr const char* kSimTruth = "SIM_TRUTH";

// procman's, on an LCM URL of their own
inline constexpr const char* kProcmanInfo = "PM_INFO";
inline constexpr const char* kProcmanOrders = "PM_ORDERS";
inline constexpr const char* kProcmanOutput = "PM_OUTPUT";
inline constexpr const char* kProcmanDiscover = "PM_DISCOVER";

}  // namespace luminav::channels
