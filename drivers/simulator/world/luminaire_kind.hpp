#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace luminav {

struct Building;
struct Fixture;

/// How a luminaire is built. The robot believes size, shape and number of lamps alone; the simulated camera shows this.
enum class LuminaireKind {
  kPanel,  // evenly bright, its tubes a little brighter: what stands for all where nobody chose
  kLouvre,
  kBatten,
  kOpal,
  kOpalFramed,
  kPrismatic,
  kPendant,
  kDownlight,
  kHighBay
};

/// As scenarios spell them, in the order of the kinds.
const std::vector<std::string>& luminaire_names();
/// The kind of a name; nothing when there is none of that name.
[[nodiscard]] std::optional<LuminaireKind> luminaire_named(const std::string& name);

/// Is a luminaire of that shape, size, number of lamps and height built like this? Everything may be a panel.
bool is_built_as(LuminaireKind kind, const Fixture& fixture, double ceiling_height);

/// Draws from `choice` for each fixture what it is: all of one shape, size and number of lamps are of one kind, as in
/// buildings. Where nothing of the choice fits it is a panel.
std::vector<LuminaireKind> draw_luminaires(const std::vector<LuminaireKind>& choice, const Building& building,
                                           std::uint64_t seed);

}  // namespace luminav
