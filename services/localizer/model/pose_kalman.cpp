#include "services/localizer/model/pose_kalman.hpp"

#include <cmath>

namespace luminav {
namespace {

/// A symmetric matrix by its upper triangle.
struct Symmetric3 {
  double xx, xy, xt, yy, yt, tt;

  static Symmetric3 of(const Eigen::Matrix3d& m) { return {m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)}; }
  void store(Eigen::Matrix3d& m) const { m << xx, xy, xt, xy, yy, yt, xt, yt, tt; }
};

}  // namespace

void predict(PoseBelief& belief, const Pose2& delta, const Eigen::Matrix3d& noise) {
  const double c = std::cos(belief.pose.theta);
  const double s = std::sin(belief.pose.theta);
  const double dx = c * delta.x - s * delta.y;
  const double dy = s * delta.x + c * delta.y;
  belief.pose = {belief.pose.x + dx, belief.pose.y + dy, wrap_angle(belief.pose.theta + delta.theta)};
  // F P F' with F = [1 0 -dy; 0 1 dx; 0 0 1]
  const Symmetric3 p = Symmetric3::of(belief.covariance);
  const double xt = p.xt - dy * p.tt;
  const double yt = p.yt + dx * p.tt;
  // R Q R'
  const Symmetric3 q = Symmetric3::of(noise);
  const double ax = c * q.xx - s * q.xy;
  const double ay = c * q.xy - s * q.yy;
  const double bx = s * q.xx + c * q.xy;
  const double by = s * q.xy + c * q.yy;
  const Symmetric3 moved{.xx = p.xx - dy * (p.xt + xt) + c * ax - s * ay,
                         .xy = p.xy + dx * p.xt - dy * yt + s * ax + c * ay,
                         .xt = xt + c * q.xt - s * q.yt,
                         .yy = p.yy + dx * (p.yt + yt) + s * bx + c * by,
                         .yt = yt + s * q.xt + c * q.yt,
                         .tt = p.tt + q.tt};
  moved.store(belief.covariance);
}

void fuse_pose(PoseBelief& belief, const Eigen::Vector3d& offset, const Eigen::Matrix3d& covariance) {
  const Symmetric3 p = Symmetric3::of(belief.covariance);
  const Symmetric3 r = Symmetric3::of(covariance);
  const Symmetric3 s{p.xx + r.xx, p.xy + r.xy, p.xt + r.xt, p.yy + r.yy, p.yt + r.yt, p.tt + r.tt};
  // inverse by cofactors
  const double a = s.yy * s.tt - s.yt * s.yt;
  const double b = s.xt * s.yt - s.xy * s.tt;
  const double c = s.xy * s.yt - s.xt * s.yy;
  const double d = s.xx * s.tt - s.xt * s.xt;
  const double e = s.xy * s.xt - s.xx * s.yt;
  const double f = s.xx * s.yy - s.xy * s.xy;
  const double scale = 1.0 / (s.xx * a + s.xy * b + s.xt * c);
  // gain K = P S^-1
  const double k00 = scale * (p.xx * a + p.xy * b + p.xt * c);
  const double k01 = scale * (p.xx * b + p.xy * d + p.xt * e);
  const double k02 = scale * (p.xx * c + p.xy * e + p.xt * f);
  const double k10 = scale * (p.xy * a + p.yy * b + p.yt * c);
  const double k11 = scale * (p.xy * b + p.yy * d + p.yt * e);
  const double k12 = scale * (p.xy * c + p.yy * e + p.yt * f);
  const double k20 = scale * (p.xt * a + p.yt * b + p.tt * c);
  const double k21 = scale * (p.xt * b + p.yt * d + p.tt * e);
  const double k22 = scale * (p.xt * c + p.yt * e + p.tt * f);
  belief.pose.x += k00 * offset.x() + k01 * offset.y() + k02 * offset.z();
  belief.pose.y += k10 * offset.x() + k11 * offset.y() + k12 * offset.z();
  belief.pose.theta = wrap_angle(belief.pose.theta + k20 * offset.x() + k21 * offset.y() + k22 * offset.z());
  // (I - K) P: a large variance of what was not measured comes in through the gain alone
  const Symmetric3 corrected{.xx = p.xx - (k00 * p.xx + k01 * p.xy + k02 * p.xt),
                             .xy = p.xy - (k00 * p.xy + k01 * p.yy + k02 * p.yt),
                             .xt = p.xt - (k00 * p.xt + k01 * p.yt + k02 * p.tt),
                             .yy = p.yy - (k10 * p.xy + k11 * p.yy + k12 * p.yt),
                             .yt = p.yt - (k10 * p.xt + k11 * p.yt + k12 * p.tt),
                             .tt = p.tt - (k20 * p.xt + k21 * p.yt + k22 * p.tt)};
  corrected.store(belief.covariance);
}

}  // namespace luminav
