#include "tests/system/faults/torture/torture_scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

namespace luminav {
namespace {

constexpr double kUnplugEvery = 80.0;  // [s]
constexpr double kSenseEvery = 45.0;   // [s] of those that are asked for by name
constexpr double kSenseDead = 14.0;    // [s]
constexpr const char* kPlaces[] = {"workbench",      "seminar",       "office-1", "office-3",
                                   "north-corridor", "east-corridor", "lift"};

constexpr DeadSense kSenses[] = {
    {"deafen all sonars", "kind = \"deafen\"", "controller"},
    {"deafen front sonars", "kind = \"deafen\"\ndiscs = [0, 1, 2, 3, 4, 5, 6, 7]", "controller"},
    {"stick all sonars", "kind = \"stick\"", "controller"},
    {"left encoder dead", "kind = \"freeze\"\ndevice = \"encoder_left\"", "p3dx"},
    {"right encoder dead", "kind = \"freeze\"\ndevice = \"encoder_right\"", "p3dx"},
    {"repeat pictures", "kind = \"freeze\"\ndevice = \"camera\"", "camera"},
    {"cover the lens", "kind = \"cover\"", "camera"}};

/// The world's own faults: plugs, and senses in turn; of those that are asked for by name only these.
void write_events(std::ofstream& out, const TortureScenario& plan) {
  std::mt19937_64 random(plan.seed + 1);
  std::uniform_real_distribution<double> jitter(-8.0, 8.0);
  std::uniform_real_distribution<double> duration(1.5, 4.0);
  std::vector<DeadSense> senses;
  std::copy_if(std::begin(kSenses), std::end(kSenses), std::back_inserter(senses),
               [&](const DeadSense& sense) { return std::string(sense.name).find(plan.only) != std::string::npos; });
  std::shuffle(senses.begin(), senses.end(), random);
  std::size_t turn = 0;
  const double every = plan.only.empty() ? kUnplugEvery : kSenseEvery;
  for (double at = every; at < 60.0 * plan.minutes; at += every, ++turn) {
    out << fmt::format("[[event]]\nat = {:.1f}\n", at + jitter(random));
    if (plan.only.empty() && turn % 2 == 0) {
      out << fmt::format("kind = \"unplug\"\ndevice = \"{}\"\nduration = {:.1f}\n", turn % 4 == 0 ? "serial" : "camera",
                         duration(random));
    } else {
      const std::size_t number = plan.only.empty() ? turn / 2 : turn;
      out << fmt::format("{}\nduration = {:.1f}\n", senses[number % senses.size()].event, kSenseDead);
    }
  }
}

}  // namespace

const DeadSense* sense_of(const ScenarioEvent& event) {
  switch (event.kind) {
    case EventKind::kDeafen:
      return event.discs.empty() ? &kSenses[0] : &kSenses[1];
    case EventKind::kStick:
      return &kSenses[2];
    case EventKind::kFreeze:
      return event.device == "encoder_left" ? &kSenses[3] : event.device == "encoder_right" ? &kSenses[4] : &kSenses[5];
    case EventKind::kCover:
      return &kSenses[6];
    default:
      return nullptr;
  }
}

bool names_a_dead_sense(const std::string& only) {
  return std::any_of(std::begin(kSenses), std::end(kSenses),
                     [&](const DeadSense& sense) { return std::string(sense.name).find(only) != std::string::npos; });
}

void write_torture_scenario(const std::filesystem::path& file, const TortureScenario& plan) {
  std::mt19937_64 random(plan.seed);
  const std::string launch = LUMINAV_SOURCE_DIR "/launch";
  std::ofstream out(file);
  out << fmt::format("building = \"{0}/buildings/laboratory/building.toml\"\nrobot = \"{0}/robots/p3dx.toml\"\n",
                     launch);
  out << fmt::format("seed = {}\nduration = {}\n[lighting]\ndaylight = 0.5\n", plan.seed, 60.0 * plan.minutes + 600.0);
  out << "[start]\nx = 5.4\ny = 5.6\ntheta = 0.3\nknown = true\n";
  out << "[[obstacle]]\nlength = 0.6\nwidth = 0.4\n[[obstacle]]\nlength = 0.5\nwidth = 0.5\n";
  out << "[[obstacle]]\nlength = 0.8\nwidth = 0.3\n[[person]]\nspeed = 0.8\n[[person]]\nspeed = 0.6\n";
  std::vector<std::string> places(std::begin(kPlaces), std::end(kPlaces));
  std::string last;
  for (int i = 0; i < 10; ++i) {
    do {
      std::shuffle(places.begin(), places.end(), random);
    } while (places.front() == last);
    for (const std::string& place : places) {
      out << fmt::format("[[goal]]\nplace = \"{}\"\n", place);
    }
    last = places.back();
  }
  if (plan.only.empty() || names_a_dead_sense(plan.only)) {
    write_events(out, plan);
  }
}

}  // namespace luminav
