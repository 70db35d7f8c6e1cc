#include "services/planner/path/path_shaper.hpp"

#include <algorithm>
#include <utility>

namespace luminav {
namespace {

constexpr double kAboutJoint = 4.0;  // [m] to both sides of where two sections meet

/// How far [m] from a chain anything may matter to its shape: a band is relaxed twice, and looks at the cells around;
/// who keeps to a side looks at the whole corridor.
double reach_of(const PathShapingParams& params, const GridGeometry& geometry) {
  return 2.0 * params.smoothing_rounds * params.push + 4.0 * geometry.resolution +
         (params.keep_side == KeepSide::kNone ? 0.0 : kSideReach);
}

}  // namespace

Polyline PathShaper::shape_piece(const ConfigurationSpace& space, Polyline chain) {
  const auto same = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) { return kept.chain == chain; });
  if (same != kept_.end()) {
    same->is_used = true;
    return same->shaped;
  }
  Polyline shaped = shape_path(space, params_, chain);
  kept_.push_back({std::move(chain), shaped, true});
  return shaped;
}

void PathShaper::append(const ConfigurationSpace& space, const Polyline& section, Polyline& path) {
  if (path.empty()) {
    path = section;
    return;
  }
  const auto about = static_cast<std::size_t>(kAboutJoint / params_.spacing);
  const auto before = static_cast<std::ptrdiff_t>(std::min(about, path.size() - 1));
  const auto behind = static_cast<std::ptrdiff_t>(std::min(about, section.size() - 1));
  // the last point of the path is the first one of the section
  Polyline joint(path.end() - before - 1, path.end());
  joint.insert(joint.end(), section.begin() + 1, section.begin() + behind + 1);
  const Polyline shaped = shape_piece(space, std::move(joint));
  path.erase(path.end() - before - 1, path.end());
  path.insert(path.end(), shaped.begin(), shaped.end());
  path.insert(path.end(), section.begin() + behind + 1, section.end());
}

Polyline PathShaper::shape(const ConfigurationSpace& space, const Polyline& chain) {
  const double resolution = space.geometry().resolution;
  if (static_cast<double>(chain.size()) * resolution <= kLongestWhole) {
    return shape_path(space, params_, chain);
  }
  const auto section = static_cast<std::size_t>(kSection / resolution);
  std::vector<std::size_t> cuts = {chain.size() - 1};
  while (cuts.back() >= 2 * section) {
    cuts.push_back(cuts.back() - section);
  }
  cuts.push_back(0);
  for (Kept& kept : kept_) {
    kept.is_used = false;
  }
  Polyline path;
  for (std::size_t i = cuts.size() - 1; i > 0; --i) {
    const auto from = chain.begin() + static_cast<std::ptrdiff_t>(cuts[i]);
    const auto to = chain.begin() + static_cast<std::ptrdiff_t>(cuts[i - 1]);
    append(space, shape_piece(space, Polyline(from, to + 1)), path);
  }
  std::erase_if(kept_, [](const Kept& kept) { return !kept.is_used; });
  return path;
}

void PathShaper::forget(const GridGeometry& geometry, const CellWindow& window) {
  if (window.is_empty()) {
    return;
  }
  const double reach = reach_of(params_, geometry);
  const Eigen::Vector2d around(reach, reach);
  const Eigen::Vector2d low = geometry.centre_of({window.first_column, window.first_row}) - around;
  const Eigen::Vector2d high = geometry.centre_of({window.last_column, window.last_row}) + around;
  std::erase_if(kept_, [&](const Kept& kept) {
    Eigen::Vector2d lowest = kept.chain.front();
    Eigen::Vector2d highest = lowest;
    for (const Eigen::Vector2d& point : kept.chain) {
      lowest = lowest.cwiseMin(point);
      highest = highest.cwiseMax(point);
    }
    return (lowest.array() <= high.array()).all() && (highest.array() >= low.array()).all();
  });
}

}  // namespace luminav
