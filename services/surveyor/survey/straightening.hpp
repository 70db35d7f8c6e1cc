#pragma once

#include "services/surveyor/survey/survey_graph.hpp"

namespace luminav {

/// Direction [rad] along which, or across which, most fixtures hang; modulo a quarter turn.
double dominant_direction(const SurveyEstimate& estimate, const CeilingKinds& kinds);

/// Turns the whole estimate so that `direction` [rad] lies along an axis and the longer side of what was driven along
/// x, and moves it so that no pose or fixture has a negative coordinate.
void straighten(SurveyEstimate& estimate, double direction);

/// A covariance of (x, y, theta) in axes that are turned by an angle [rad].
Eigen::Matrix3d turned(const Eigen::Matrix3d& covariance, double angle);

/// Moves the whole estimate.
void transform(SurveyEstimate& estimate, const Pose2& new_from_old);

}  // namespace luminav
