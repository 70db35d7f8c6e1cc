#include "services/localizer/paper/particle_filter.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "services/localizer/paper/particle_math.hpp"

namespace luminav {
namespace {

constexpr std::size_t kBlock = 256;       // particles worked on at once: their arrays stay in the fastest cache
constexpr std::size_t kMaxSightings = 8;  // a product of more could leave the range of float
constexpr std::size_t kNoise = 65536 + kBlock;

/// Values of one block, beside the particles.
using BlockValues = std::array<float, kBlock>;

/// From each particle to the fixture nearest to where it has a sighting.
struct NearestOffsets {
  BlockValues dx, dy;         // [m] world axes
  BlockValues theta, period;  // [rad] of the fixture
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

// The loops below are plain: the compiler makes vector instructions of them, the same for every x86-64 machine.

/// Moves particles by a step with three noises each.
void move(const NoisyStep& step, const std::array<const float*, 3>& noise, float* __restrict x, float* __restrict y,
          float* __restrict theta, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const float heading = theta[i] + step.first_turn + step.first_sigma * noise[0][i];
    const float distance = step.distance + step.distance_sigma * noise[1][i];
    x[i] += distance * cosine(heading);
    y[i] += distance * sine(heading);
    theta[i] = wrap_float(heading + step.second_turn + step.second_sigma * noise[2][i]);
  }
}

/// Squared distance and heading difference, modulo the fixture's symmetry, of a sighting and the nearest fixture.
struct Misfits {
  BlockValues squared, turn;
};

void compare(const NearestOffsets& offsets, const Eigen::Matrix2f& metric, float seen_theta, const float* theta,
             const BlockValues& cosines, const BlockValues& sines, Misfits& misfits, std::size_t count) {
  const float xx = metric(0, 0);
  const float xy = 2.0F * metric(0, 1);
  const float yy = metric(1, 1);
  const float max =
      std::max(xx, yy) * static_cast<float>(NearestFixtureGrid::kFarthest * NearestFixtureGrid::kFarthest);
  for (std::size_t i = 0; i < count; ++i) {
    const float forward = cosines[i] * offsets.dx[i] + sines[i] * offsets.dy[i];
    const float left = cosines[i] * offsets.dy[i] - sines[i] * offsets.dx[i];
    const float squared = xx * forward * forward + xy * forward * left + yy * left * left;
    misfits.squared[i] = std::min(max, std::max(0.0F, squared));
    const float period = offsets.period[i];
    const float turn = theta[i] + seen_theta - offsets.theta[i];
    const float wrapped = turn - period * nearest_integer(turn / std::max(1e-3F, period));
    misfits.turn[i] = period > 0.0F ? wrapped : 0.0F;  // a round one has no heading
  }
}

void add_equation_one(const Misfits& misfits, float angle_gain, float* __restrict sums, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    sums[i] += 1.0F / (1.0F + std::sqrt(misfits.squared[i]) + angle_gain * std::abs(misfits.turn[i]));
  }
}

void multiply_gaussian(const Misfits& misfits, float angle_gain, float floor, float* __restrict products,
                       std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    products[i] *= floor + exponential(-misfits.squared[i] - angle_gain * misfits.turn[i] * misfits.turn[i]);
  }
}

}  // namespace

ParticleFilter::ParticleFilter(const FixtureMap& map, const WallField& walls, const ParticleParams& params,
                               std::uint64_t seed)
    : map_(map),
      walls_(walls),
      nearest_(map),
      params_(params),
      random_(seed),
      noise_(kNoise),
      floor_(extent_of_floor(walls.map(), map)),
      count_(count_of(params, walls, floor_.sizes())) {
  weight_.assign(count_, 0.0F);
  for (std::vector<float>* values : {&x_, &y_, &theta_}) {
    values->assign(count_ + 2, 0.0F);  // resampling writes up to two beyond the end
  }
  if (params_.resampling == ParticleResampling::kSystematic) {
    spare_x_ = spare_y_ = spare_theta_ = x_;
  } else {
    order_.resize(count_);
  }
  std::generate(noise_.begin(), noise_.end(), [&] { return static_cast<float>(random_.gauss()); });
  scatter();
}

std::size_t ParticleFilter::memory_bytes() const {
  std::size_t bytes = order_.capacity() * sizeof(std::uint32_t);
  for (const std::vector<float>* values : {&x_, &y_, &theta_, &weight_, &spare_x_, &spare_y_, &spare_theta_}) {
    bytes += values->capacity() * sizeof(float);
  }
  return bytes;
}

const float* ParticleFilter::noise() {
  return &noise_[random_.next() % (kNoise - kBlock)];
}

void ParticleFilter::predict(const Pose2& delta) {
  const NoisyStep step = noisy_step(delta, params_);
  const bool is_confined = walls_.has_walls() && std::abs(step.distance) > 1e-6F;
  BlockValues x, y, theta;  // before the step
  for (std::size_t begin = 0; begin < count_; begin += kBlock) {
    const std::size_t count = std::min(kBlock, count_ - begin);
    std::copy_n(&x_[begin], count, x.begin());
    std::copy_n(&y_[begin], count, y.begin());
    std::copy_n(&theta_[begin], count, theta.begin());
    move(step, {noise(), noise(), noise()}, &x_[begin], &y_[begin], &theta_[begin], count);
    for (std::size_t i = 0; is_confined && i < count; ++i) {
      if (!walls_.is_free({x_[begin + i], y_[begin + i]})) {
        move_again(begin + i, {x[i], y[i], theta[i]}, step);
      }
    }
  }
}

void ParticleFilter::move_again(std::size_t particle, const Pose2& from, const NoisyStep& step) {
  Pose2 pose;
  for (int attempt = 0; attempt < params_.redraws; ++attempt) {
    const double heading = from.theta + step.first_turn + step.first_sigma * random_.gauss();
    const double distance = step.distance + step.distance_sigma * random_.gauss();
    const double after = step.second_turn + step.second_sigma * random_.gauss();
    pose = {from.x + distance * std::cos(heading), from.y + distance * std::sin(heading), wrap_angle(heading + after)};
    if (walls_.is_free(pose.position())) {
      place(particle, pose);
      return;
    }
  }
  place(particle, from);
  weight_[particle] = 0.0F;  // among the worst, which the next update replaces
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
  const bool is_mean = params_.scoring == ParticleScoring::kEquationOne;
  // equation 1's distance in the sighting's own covariance: where the image's border cut a fixture, along it counts
  // less
  const double scale = 1.0 / params_.distance_gain;
  const double variance = params_.position_sigma * params_.position_sigma;
  const Eigen::Matrix2d spread =
      is_mean ? Eigen::Matrix2d(sighting.covariance.topLeftCorner<2, 2>() + scale * scale * Eigen::Matrix2d::Identity())
              : Eigen::Matrix2d(2.0 * variance * Eigen::Matrix2d::Identity());
  const double angle_gain = is_mean ? params_.angle_gain : 0.5 / (params_.heading_sigma * params_.heading_sigma);
  return {.seen = sighting.robot_from_fixture,
          .metric = spread.inverse().cast<float>(),
          .angle_gain = sighting.has_theta ? static_cast<float>(angle_gain) : 0.0F};
}

void ParticleFilter::score_block(const float* x, const float* y, const float* theta,
                                 const std::vector<ScoredSighting>& sightings, float* scores, std::size_t count) const {
  const bool is_mean = params_.scoring == ParticleScoring::kEquationOne;
  std::fill_n(scores, count, is_mean ? 0.0F : 1.0F);
  BlockValues cosines, sines;
  for (std::size_t i = 0; i < count; ++i) {
    cosines[i] = cosine(theta[i]);
    sines[i] = sine(theta[i]);
  }
  NearestOffsets offsets;
  Misfits misfits;
  for (const ScoredSighting& sighting : sightings) {
    const auto seen_x = static_cast<float>(sighting.seen.x);
    const auto seen_y = static_cast<float>(sighting.seen.y);
    for (std::size_t i = 0; i < count; ++i) {
      const float place_x = x[i] + cosines[i] * seen_x - sines[i] * seen_y;
      const float place_y = y[i] + sines[i] * seen_x + cosines[i] * seen_y;
      const NearestFixtureGrid::Entry& fixture = nearest_.at(place_x, place_y);
      offsets.dx[i] = fixture.x - place_x;
      offsets.dy[i] = fixture.y - place_y;
      offsets.theta[i] = fixture.theta;
      offsets.period[i] = fixture.period;
    }
    compare(offsets, sighting.metric, static_cast<float>(sighting.seen.theta), theta, cosines, sines, misfits, count);
    if (is_mean) {
      add_equation_one(misfits, sighting.angle_gain, scores, count);
    } else {
      multiply_gaussian(misfits, sighting.angle_gain, static_cast<float>(params_.outlier), scores, count);
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
  const auto x = static_cast<float>(pose.x);
  const auto y = static_cast<float>(pose.y);
  const auto theta = static_cast<float>(pose.theta);
  float score = 0.0F;
  score_block(&x, &y, &theta, scored, &score, 1);
  return static_cast<double>(score);
}

void ParticleFilter::update(const std::vector<FixtureSighting>& sightings) {
  if (sightings.empty()) {
    return;
  }
  redraw_share(sightings);
  std::vector<ScoredSighting> scored;
  for (std::size_t i = 0; i < std::min(kMaxSightings, sightings.size()); ++i) {
    scored.push_back(prepare(sightings[i]));
  }
  for (std::size_t begin = 0; begin < count_; begin += kBlock) {
    weigh(begin, std::min(kBlock, count_ - begin), scored);
  }
  if (params_.resampling == ParticleResampling::kSystematic) {
    resample_systematically();
  } else {
    replace_worst(sightings);
  }
}

void ParticleFilter::weigh(std::size_t begin, std::size_t count, const std::vector<ScoredSighting>& sightings) {
  const bool carries = params_.resampling == ParticleResampling::kReplaceWorst;
  BlockValues scores;
  score_block(&x_[begin], &y_[begin], &theta_[begin], sightings, scores.data(), count);
  if (params_.scoring == ParticleScoring::kEquationOne) {
    const float* norm = noise();
    const auto sigma = static_cast<float>(params_.weight_jitter);
    for (std::size_t i = 0; i < count; ++i) {
      scores[i] = std::max(1e-9F, scores[i] + sigma * norm[i]);  // negative weights have no meaning
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    weight_[begin + i] = carries ? weight_[begin + i] * scores[i] : scores[i];
  }
}

void ParticleFilter::normalise_weights() {
  const auto scale = static_cast<float>(1.0 / std::accumulate(weight_.begin(), weight_.end(), 0.0));
  for (float& weight : weight_) {
    weight *= scale;
  }
}

// Kitagawa 1996. Most particles have none, one or two copies: two are written without asking, and the next particle
// overwrites what is too much.
void ParticleFilter::resample_systematically() {
  normalise_weights();
  const auto count = static_cast<double>(count_);
  const double offset = random_.uniform();
  double sum = 0.0;
  std::size_t done = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    sum += static_cast<double>(weight_[i]);
    const bool is_last = i + 1 == count_;  // it stands in for what rounding leaves over
    const std::size_t next = is_last ? count_ : std::min(count_, static_cast<std::size_t>(sum * count + offset));
    for (std::size_t k = done; k < std::max(next, done + 2); ++k) {
      spare_x_[k] = x_[i];
      spare_y_[k] = y_[i];
      spare_theta_[k] = theta_[i];
    }
    done = next;
  }
  x_.swap(spare_x_);
  y_.swap(spare_y_);
  theta_.swap(spare_theta_);
  std::fill_n(weight_.begin(), count_, 1.0F / static_cast<float>(count_));
  const auto random = static_cast<std::size_t>(params_.random_share * count);
  for (std::size_t k = 0; k < random; ++k) {
    draw(k * count_ / random);  // particles of one origin lie side by side: spread over all of them
  }
}

void ParticleFilter::replace_worst(const std::vector<FixtureSighting>& sightings) {
  normalise_weights();
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
    weight_[worst] = static_cast<float>(params_.drawn_weight / static_cast<double>(count_));
  }
  for (std::ptrdiff_t k = 0; k < copied; ++k) {
    const std::uint32_t from = *(order_.begin() + k);
    const std::uint32_t to = *(worst_begin + k);
    x_[to] = x_[from];
    y_[to] = y_[from];
    theta_[to] = theta_[from];
    weight_[to] = weight_[from] *= 0.5F;  // both together stand for what the one stood for
  }
  normalise_weights();
}

}  // namespace luminav
