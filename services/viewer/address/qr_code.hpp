#pragma once

#include <string>

namespace luminav {

/// The text as a QR code for a terminal, two modules a letter, black on white whatever the terminal's colours are; ""
/// for a text that is too long for one.
std::string qr_code(const std::string& text);

/// The same as an SVG picture for paper: a module is a unit, the margin is the standard's four. A seventh of it may be
/// damaged, as by a drawing pin.
std::string qr_picture(const std::string& text);

}  // namespace luminav
