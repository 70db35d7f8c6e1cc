#pragma once

namespace luminav {

/// Work that may be done in one step, counted in units and never in time: same input, same answers on any machine. A
/// unit is about a quarter of a microsecond on a desk machine of 2021.
class WorkBudget {
 public:
  explicit WorkBudget(int units) : units_(units), left_(units) {}

  void renew() { left_ = units_; }
  [[nodiscard]] bool is_spent() const { return left_ <= 0; }
  void spend(int units) { left_ -= units; }
  /// Whether work that cannot be interrupted may begin: it fits, or nothing else was done in this step.
  [[nodiscard]] bool allows(int units) const { return left_ >= units || left_ == units_; }
  /// Nothing more in this step.
  void close() { left_ = left_ < 0 ? left_ : 0; }
  /// Since it was renewed.
  [[nodiscard]] int spent() const { return units_ - left_; }

 private:
  int units_;
  int left_;
};

}  // namespace luminav
