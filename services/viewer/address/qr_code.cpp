#include "services/viewer/address/qr_code.hpp"

#include <fmt/format.h>
#include <qrencode.h>

#include <memory>

namespace luminav {
namespace {

/// The modules of a code, white beyond its edges.
class Modules {
 public:
  Modules(const std::string& text, QRecLevel level)
      : code_(QRcode_encodeString(text.c_str(), 0, level, QR_MODE_8, 1), QRcode_free) {}

  /// 0 for a text that is too long.
  [[nodiscard]] int width() const { return code_ == nullptr ? 0 : code_->width; }
  [[nodiscard]] bool is_black(int column, int row) const {
    const bool is_inside = column >= 0 && row >= 0 && column < width() && row < width();
    return is_inside && (code_->data[row * width() + column] & 1) != 0;
  }

 private:
  std::unique_ptr<QRcode, decltype(&QRcode_free)> code_;
};

}  // namespace

std::string qr_code(const std::string& text) {
  const Modules code(text, QR_ECLEVEL_L);
  if (code.width() == 0) {
    return "";
  }
  constexpr int kMargin = 2;  // [modules] half of what the standard asks for; phones read it
  std::string lines;
  for (int row = -kMargin; row < code.width() + kMargin; row += 2) {
    lines += "\033[30;107m";
    for (int column = -kMargin; column < code.width() + kMargin; ++column) {
      const bool upper = code.is_black(column, row);
      const bool lower = code.is_black(column, row + 1);
      lines += upper && lower ? "█" : upper ? "▀" : lower ? "▄" : " ";
    }
    lines += "\033[0m\n";
  }
  return lines;
}

std::string qr_picture(const std::string& text) {
  const Modules code(text, QR_ECLEVEL_M);
  if (code.width() == 0) {
    return "";
  }
  constexpr int kMargin = 4;
  const int size = code.width() + 2 * kMargin;
  std::string bars;
  for (int row = 0; row < code.width(); ++row) {
    for (int column = 0; column < code.width(); ++column) {
      const int first = column;
      while (code.is_black(column, row)) {
        ++column;
      }
      if (column > first) {
        bars += fmt::format("M{} {}h{}v1h-{}z", first + kMargin, row + kMargin, column - first, column - first);
      }
    }
  }
  return fmt::format(R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {0}" shape-rendering="crispEdges">)"
                     R"(<path fill="#fff" d="M0 0h{0}v{0}H0z"/><path d="{1}"/></svg>)",
                     size, bars);
}

}  // namespace luminav
