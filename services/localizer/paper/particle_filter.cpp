#include "services/localizer/paper/particle_filter.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace luminav {
namespace {

constexpr std::size_t kLanes = 8;
constexpr std::size_t kBlock = 256;       // particles worked on at once: all their arrays stay in the first-level cache
constexpr std::size_t kMaxSightings = 8;  // a product of more could leave the range of float

std::size_t with_room(std::size_t count) {
  return (count + kLanes - 1) / kLanes * kLanes + kLanes;  // resampling writes up to eight beyond the end
}

/// What one block needs beside the particles.
struct BlockSpace {
  alignas(32) std::array<float, kBlock> cosine, sine, projected_x, projected_y, dx, dy, theta, period;
};

NoisyStep noisy_step(const Pose2& delta, const ParticleParams& params) {
  const double distance = std::hypot(delta.x, delta.y);
  // below a centimetre the direction of the step is noise
  const double first = distance < 0.01 ? 0.0 : std::atan2(delta.y, delta.x);
  const double direction = std::abs(first) > 0.5 * kPi ? -1.0 : 1.0;  // driving backwards is no half turn
  const double first_turn = direction > 0.0 ? first : wrap_angle(first - kPi);
  const double second_turn = wrap_angle(delta.theta - first_turn);
  const double turns = std::abs(first_turn) + std::abs(second_turn);
  NoisyStep step;
  step.first_turn = static_cast<float>(first_turn);
  step.distance = static_cast<float>(direction * distance);
  step.second_turn = static_cast<float>(second_turn);
  step.first_sigma =
      static_cast<float>(params.noise.turn_by_turn * std::abs(first_turn) + params.noise.turn_by_distance * distance);
  step.distance_sigma =
      static_cast<float>(params.noise.distance_by_distance * distance + params.noise.distance_by_turn * turns);
  step.second_sigma =
      static_cast<float>(params.noise.turn_by_turn * std::abs(second_turn) + params.noise.turn_by_distance * distance);
  return step;
}

/// Sums of weight, x, y, cosine, sine, xx, xy, yy, x theta, y theta, theta theta, theta about a reference pose.
using MomentSums = Eigen::Matrix<double, 12, 1>;

/// Mean and spread of particles; `m`: their sums for a weight of one.
PoseBelief belief_of(const MomentSums& m, const Pose2& reference) {
  PoseBelief belief;
  belief.pose = {reference.x + m[1], reference.y + m[2], wrap_angle(reference.theta + std::atan2(m[4], m[3]))};
  const Eigen::Vector3d mean(m[1], m[2], m[11]);
  belief.covariance << m[5], m[6], m[8], m[6], m[7], m[9], m[8], m[9], m[10];
  belief.covariance -= mean * mean.transpose();
  return belief;
}

/// As many as asked for, or by the floor to search.
std::size_t count_of(const ParticleParams& params, const WallField& walls, const Eigen::Vector2d& extent) {
  constexpr double kMax = 1e6;
  double count = params.count;
  if (params.count == 0) {
    double area = extent.x() * extent.y();
    if (walls.has_walls()) {
      const PriorMap& map = walls.map();
      area = std::pow(map.geometry.resolution, 2) *
             static_cast<double>(std::count(map.cells.begin(), map.cells.end(), Prior::kFree));
    }
    count = params.density * area;
  }
  return static_cast<std::size_t>(std::clamp(count, 1.0, kMax));
}

}  // namespace

ParticleFilter::ParticleFilter(const FixtureMap& map, const WallField& walls, const ParticleParams& params,
                               std::uint64_t seed)
    : map_(map),
      walls_(walls),
      nearest_(map),
      kernels_(particle_kernels()),
      params_(params),
      random_(seed),
      min_(-5.0, -5.0),
      max_(5.0, 5.0) {
  if (walls_.has_walls()) {
    const GridGeometry& geometry = walls_.map().geometry;
    min_ = geometry.origin;
    max_ = geometry.origin + geometry.resolution * Eigen::Vector2d(geometry.columns, geometry.rows);
  } else if (map.size() > 0) {
    min_ = max_ = map[0].world_from_fixture.position();
    for (const Fixture& fixture : map.fixtures()) {
      min_ = min_.cwiseMin(fixture.world_from_fixture.position());
      max_ = max_.cwiseMax(fixture.world_from_fixture.position());
    }
    min_ -= Eigen::Vector2d(2.0, 2.0);
    max_ += Eigen::Vector2d(2.0, 2.0);
  }
  count_ = count_of(params, walls_, max_ - min_);
  for (std::vector<float>* values : {&x_, &y_, &theta_, &weight_}) {
    values->assign(with_room(count_), 0.0F);
  }
  if (params_.resampling == ParticleResampling::kSystematic) {
    for (std::vector<float>* values : {&spare_x_, &spare_y_, &spare_theta_}) {
      values->assign(with_room(count_), 0.0F);
    }
  } else {
    order_.resize(count_);
  }
  scored_.reserve(kMaxSightings);
  scatter();
}

std::size_t ParticleFilter::memory_bytes() const {
  std::size_t bytes = order_.capacity() * sizeof(std::uint32_t);
  for (const std::vector<float>* values : {&x_, &y_, &theta_, &weight_, &spare_x_, &spare_y_, &spare_theta_}) {
    bytes += values->capacity() * sizeof(float);
  }
  return bytes;
}

NoiseKey ParticleFilter::next_key() {
  const std::uint64_t bits = random_.next();
  return {static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32)};
}

void ParticleFilter::predict(const Pose2& delta) {
  const NoisyStep step = noisy_step(delta, params_);
  const NoiseKey key = next_key();
  const bool is_confined = walls_.has_walls() && std::abs(step.distance) > 1e-6F;
  for (std::size_t begin = 0; begin < count_; begin += kBlock) {
    const std::size_t count = std::min(kBlock, count_ - begin);
    if (is_confined) {
      move_inside_walls(step, begin, count, key);
    } else {
      kernels_.move(step, key, begin, &x_[begin], &y_[begin], &theta_[begin], count);
    }
  }
}

void ParticleFilter::move_inside_walls(const NoisyStep& step, std::size_t begin, std::size_t count, NoiseKey key) {
  std::array<float, kBlock> x;
  std::array<float, kBlock> y;
  std::array<float, kBlock> theta;
  std::copy_n(&x_[begin], count, x.begin());
  std::copy_n(&y_[begin], count, y.begin());
  std::copy_n(&theta_[begin], count, theta.begin());
  kernels_.move(step, key, begin, &x_[begin], &y_[begin], &theta_[begin], count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t particle = begin + i;
    bool is_placed = walls_.is_free({x_[particle], y_[particle]});
    for (int attempt = 0; attempt < params_.redraws && !is_placed; ++attempt) {
      const double heading = theta[i] + step.first_turn + step.first_sigma * random_.gauss();
      const double distance = step.distance + step.distance_sigma * random_.gauss();
      const double after = step.second_turn + step.second_sigma * random_.gauss();
      const Eigen::Vector2d place(x[i] + distance * std::cos(heading), y[i] + distance * std::sin(heading));
      is_placed = walls_.is_free(place);
      x_[particle] = static_cast<float>(place.x());
      y_[particle] = static_cast<float>(place.y());
      theta_[particle] = static_cast<float>(wrap_angle(heading + after));
    }
    if (!is_placed) {
      x_[particle] = x[i];
      y_[particle] = y[i];
      theta_[particle] = theta[i];
      weight_[particle] = 0.0F;  // among the worst, which the next update replaces
    }
  }
}

double ParticleFilter::free_probability(const Eigen::Vector2d& point) const {
  if (!walls_.has_walls()) {
    return 1.0;
  }
  const Cell cell = walls_.map().geometry.cell_at(point);
  if (!walls_.map().geometry.contains(cell)) {
    return params_.min_free;
  }
  switch (walls_.map().at(point)) {
    case Prior::kFree:
      return 1.0;
    case Prior::kUnknown:
      return params_.unknown_free;
    default:
      return params_.min_free;
  }
}

ParticleFilter::ScoredSighting ParticleFilter::prepare(const FixtureSighting& sighting) const {
  ScoredSighting scored;
  scored.x = static_cast<float>(sighting.robot_from_fixture.x);
  scored.y = static_cast<float>(sighting.robot_from_fixture.y);
  SightingScore& score = scored.score;
  score.theta = static_cast<float>(sighting.robot_from_fixture.theta);
  score.distance_gain = static_cast<float>(params_.distance_gain);
  score.angle_gain = sighting.has_theta ? static_cast<float>(params_.angle_gain) : 0.0F;
  // equation 1's distance in the sighting's own covariance: where the image's border cut a fixture, along it counts
  // less
  const double scale = 1.0 / params_.distance_gain;
  const Eigen::Matrix2d spread =
      sighting.covariance.topLeftCorner<2, 2>() + scale * scale * Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d metric = scale * scale * spread.inverse();
  score.metric_xx = static_cast<float>(metric(0, 0));
  score.metric_xy = static_cast<float>(metric(0, 1));
  score.metric_yy = static_cast<float>(metric(1, 1));
  const double variance = params_.position_sigma * params_.position_sigma;
  score.position_precision = static_cast<float>(0.5 / variance);
  score.heading_precision =
      sighting.has_theta ? static_cast<float>(0.5 / (params_.heading_sigma * params_.heading_sigma)) : 0.0F;
  score.floor = static_cast<float>(params_.outlier);
  return scored;
}

void ParticleFilter::score_block(const float* x, const float* y, const float* theta,
                                 const std::vector<ScoredSighting>& sightings, float* scores, std::size_t count) const {
  BlockSpace space;
  const bool is_mean = params_.scoring == ParticleScoring::kEquationOne;
  std::fill_n(scores, count, is_mean ? 0.0F : 1.0F);
  kernels_.sine_cosine(theta, space.cosine.data(), space.sine.data(), count);
  const NearestOffsets offsets{space.dx.data(), space.dy.data(), space.theta.data(), space.period.data()};
  NearestFixtureGrid::BoxCandidates candidates;
  for (const ScoredSighting& sighting : sightings) {
    const PointBox box = kernels_.project(x, y, space.cosine.data(), space.sine.data(), sighting.x, sighting.y,
                                          space.projected_x.data(), space.projected_y.data(), count);
    if (nearest_.find(box, candidates) && candidates.count > 0) {
      kernels_.find_nearest(space.projected_x.data(), space.projected_y.data(), candidates.view(), offsets, count);
    } else {
      nearest_.find_each(space.projected_x.data(), space.projected_y.data(), offsets, count);
    }
    if (is_mean) {
      kernels_.add_equation_one(sighting.score, offsets, theta, space.cosine.data(), space.sine.data(), scores, count);
    } else {
      kernels_.multiply_gaussian(sighting.score, offsets, theta, scores, count);
    }
  }
  if (is_mean || walls_.has_walls()) {
    const float share = is_mean ? 1.0F / static_cast<float>(sightings.size()) : 1.0F;
    for (std::size_t i = 0; i < count; ++i) {
      scores[i] *= share * static_cast<float>(free_probability({x[i], y[i]}));
    }
  }
}

double ParticleFilter::score(const Pose2& pose, const std::vector<FixtureSighting>& sightings) const {
  std::vector<ScoredSighting> scored;
  for (const FixtureSighting& sighting : sightings) {
    scored.push_back(prepare(sighting));
  }
  std::array<float, kLanes> x;
  std::array<float, kLanes> y;
  std::array<float, kLanes> theta;
  std::array<float, kLanes> scores;
  x.fill(static_cast<float>(pose.x));
  y.fill(static_cast<float>(pose.y));
  theta.fill(static_cast<float>(pose.theta));
  score_block(x.data(), y.data(), theta.data(), scored, scores.data(), kLanes);
  return static_cast<double>(scores[0]);
}

void ParticleFilter::update(const std::vector<FixtureSighting>& sightings) {
  if (sightings.empty()) {
    return;
  }
  redraw_share(sightings);
  scored_.clear();
  for (std::size_t i = 0; i < std::min(kMaxSightings, sightings.size()); ++i) {
    scored_.push_back(prepare(sightings[i]));
  }
  const NoiseKey key = next_key();
  const Pose2 reference = pose(0);
  MomentSums sums = MomentSums::Zero();
  for (std::size_t begin = 0; begin < count_; begin += kBlock) {
    const std::size_t count = std::min(kBlock, count_ - begin);
    weigh(begin, count, key);
    const ParticleMoments m =
        kernels_.moments(&x_[begin], &y_[begin], &theta_[begin], &weight_[begin], static_cast<float>(reference.x),
                         static_cast<float>(reference.y), static_cast<float>(reference.theta), count);
    MomentSums block;
    block << m.weight, m.x, m.y, m.cosine, m.sine, m.xx, m.xy, m.yy, m.xt, m.yt, m.tt, m.t;
    sums += block;
  }
  const double total = sums[0];
  belief_ = belief_of(sums / total, reference);
  if (params_.resampling == ParticleResampling::kSystematic) {
    resample_systematically(total);
    return;
  }
  const auto scale = static_cast<float>(1.0 / total);
  for (float& weight : weight_) {
    weight *= scale;
  }
  replace_worst(sightings);
}

void ParticleFilter::weigh(std::size_t begin, std::size_t count, NoiseKey key) {
  const bool carries = params_.carries_weights && params_.resampling == ParticleResampling::kReplaceWorst;
  std::array<float, kBlock> before;
  std::copy_n(&weight_[begin], count, before.begin());
  score_block(&x_[begin], &y_[begin], &theta_[begin], scored_, &weight_[begin], count);
  if (params_.scoring == ParticleScoring::kEquationOne) {
    const auto sigma = static_cast<float>(params_.weight_jitter);
    kernels_.jitter(key, begin, sigma, 1e-9F, &weight_[begin], count);  // negative weights have no meaning
  }
  for (std::size_t i = 0; i < count && carries; ++i) {
    weight_[begin + i] *= before[i];
  }
  std::fill(&weight_[begin + count], &weight_[begin + (count + kLanes - 1) / kLanes * kLanes], 0.0F);
}

void ParticleFilter::resample_systematically(double total) {
  kernels_.resample({x_.data(), y_.data(), theta_.data()}, weight_.data(), total, random_.uniform(),
                    {spare_x_.data(), spare_y_.data(), spare_theta_.data()}, count_);
  x_.swap(spare_x_);
  y_.swap(spare_y_);
  theta_.swap(spare_theta_);
  std::fill_n(weight_.begin(), count_, 1.0F / static_cast<float>(count_));
  const auto random = static_cast<std::size_t>(params_.random_share * static_cast<double>(count_));
  for (std::size_t k = 0; k < random; ++k) {
    draw(k * count_ / random);  // particles of one origin lie side by side: spread over all of them
  }
}

void ParticleFilter::replace_worst(const std::vector<FixtureSighting>& sightings) {
  const auto random = static_cast<std::ptrdiff_t>(params_.random_share * static_cast<double>(count_));
  const auto copied = std::min(static_cast<std::ptrdiff_t>(params_.copied_share * static_cast<double>(count_)),
                               (static_cast<std::ptrdiff_t>(count_) - random) / 2);
  std::iota(order_.begin(), order_.end(), 0U);
  const auto is_heavier = [&](std::uint32_t a, std::uint32_t b) {
    return weight_[a] > weight_[b] || (weight_[a] == weight_[b] && a < b);
  };
  const auto best_end = order_.begin() + copied;
  const auto worst_begin = order_.end() - random - copied;
  std::nth_element(order_.begin(), best_end, order_.end(), is_heavier);
  if (worst_begin != order_.end()) {
    std::nth_element(best_end, worst_begin, order_.end(), is_heavier);
    std::sort(worst_begin, order_.end(), is_heavier);
  }
  for (std::ptrdiff_t k = 0; k < random; ++k) {
    const std::uint32_t worst = *(order_.end() - 1 - k);
    if (random_.uniform() < params_.facing_share) {
      draw_facing(worst, sightings);
    } else {
      draw(worst);
    }
    weight_[worst] =
        params_.carries_weights ? static_cast<float>(params_.drawn_weight / static_cast<double>(count_)) : 1e-9F;
  }
  for (std::ptrdiff_t k = 0; k < copied; ++k) {
    const std::uint32_t from = *(order_.begin() + k);
    const std::uint32_t to = *(worst_begin + k);
    x_[to] = x_[from];
    y_[to] = y_[from];
    theta_[to] = theta_[from];
    if (params_.carries_weights) {
      weight_[from] *= 0.5F;  // both together stand for what the one stood for
    }
    weight_[to] = weight_[from];
  }
  const double sum = std::accumulate(weight_.begin(), weight_.begin() + static_cast<std::ptrdiff_t>(count_), 0.0);
  for (float& weight : weight_) {
    weight = static_cast<float>(static_cast<double>(weight) / sum);
  }
}

}  // namespace luminav
