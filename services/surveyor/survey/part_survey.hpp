#pragma once

#include <vector>

#include "services/surveyor/survey/survey.hpp"

namespace luminav {

/// Makes the map of one part of a drive, its loops closed.
Survey survey_part(std::vector<KeyFrame> frames, const SurveyModel& model);

/// Joins what is one, a round of sure closures after the other: each makes the next ones surer.
void close_loops(Survey& survey, const SurveyModel& model, const SurveyGraph& graph, const BuildingPrior& prior);

/// What is believed of how buildings are, by how far the fixtures hang at right angles.
BuildingPrior prior_of(const Survey& survey);

/// Learns that, and pulls the estimate there.
BuildingPrior learn_prior(Survey& survey, const SurveyModel& model, const SurveyGraph& graph);

}  // namespace luminav
