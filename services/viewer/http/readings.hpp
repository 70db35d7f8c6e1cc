#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "services/common/building/building.hpp"
#include "services/common/process/clock.hpp"
#include "services/viewer/http/http_request.hpp"
#include "services/viewer/http/http_response.hpp"
#include "services/viewer/snapshot_board.hpp"

namespace luminav {

HttpResponse text_answer(std::string text, std::string_view type = "application/json");
/// {"error": why}.
HttpResponse refusal(int status, std::string_view why);

/// What is answered to a GET, by path.
using Readings = std::map<std::string, std::function<HttpResponse(const HttpRequest&)>>;

using BuildingNow = std::function<std::shared_ptr<const Building>()>;

/// The newest of what pages are shown, for programs that ask now and then: /api/state, /api/nodes, /api/processes,
/// /api/path, /api/hypotheses, /api/jobs, /api/survey, /api/building, /api/map, /metrics and the building's
/// /api/places. 404 for what was not heard yet. To be used by one thread; board and clock must outlive it.
Readings board_readings(const SnapshotBoard& board, const Clock& clock, BuildingNow building);

}  // namespace luminav
