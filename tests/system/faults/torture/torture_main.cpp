// Breaks the whole system on purpose while it drives, in real time, and judges it by the simulator's truth.
#include <fmt/format.h>
#include <sched.h>
#include <sys/mount.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/interrupts.hpp"
#include "services/launcher/sheriff/session.hpp"
#include "tests/system/faults/interference.hpp"
#include "tests/system/faults/torture/torture_round.hpp"
#include "tests/system/faults/torture/torture_scenario.hpp"

namespace luminav {
namespace {

constexpr double kRoundMinutes = 7.5;

struct Options {
  double minutes = 5.0;
  std::int64_t seed = 1;
  std::string report;
  std::string keep;
  std::string only;
};

/// A temporary folder unless one is to be kept.
std::filesystem::path make_folder(const std::string& keep) {
  std::string folder = keep;
  if (folder.empty()) {
    folder = (std::filesystem::temp_directory_path() / "luminav-torture-XXXXXX").string();
    if (mkdtemp(folder.data()) == nullptr) {
      throw std::runtime_error(fmt::format("{}: cannot be made", folder));
    }
  }
  std::filesystem::create_directories(folder);
  return folder;
}

/// What is missing is said.
FaultMeans find_means(const std::filesystem::path& folder, bool has_neighbour) {
  // The full disk is a small file system that only this program and its children see.
  const bool own_mounts = unshare(CLONE_NEWNS) == 0 && mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;
  const FaultMeans means{.full_disk = own_mounts && can_mount_small_disk(folder),
                         .packet_loss = PacketLoss::is_possible(),
                         .second_host = has_neighbour};
  if (!means.full_disk) {
    fmt::print("the full disk is left out: only root can mount the small file system that it is\n");
  }
  if (!means.packet_loss || !means.second_host) {
    fmt::print("what takes nft or a network of its own is left out: start it by scripts/torture\n");
  }
  return means;
}

void check_name(const std::string& only, const FaultMeans& means) {
  FaultDeck deck(1, means);
  for (int i = 0; to_string(deck.draw()).find(only) == std::string::npos && !names_a_dead_sense(only); ++i) {
    if (i > 100) {
      throw ConfigurationError(fmt::format("--only {}: no fault that can be injected here has such a name", only));
    }
  }
}

/// The exit status.
int torture(const Options& options, const std::filesystem::path& folder) {
  const std::unique_ptr<Neighbour> neighbour = has_own_network() ? std::make_unique<Neighbour>() : nullptr;
  const FaultMeans means = find_means(folder, neighbour != nullptr);
  check_name(options.only, means);
  const int rounds = std::max(2, static_cast<int>(std::lround(options.minutes / kRoundMinutes)));
  const auto seed = static_cast<std::uint64_t>(options.seed);
  FaultDeck deck(seed, means);
  std::vector<FaultResult> results;
  GoalTally goals;
  bool interrupted = false;
  try {
    for (int number = 1; number <= rounds; ++number) {
      TortureRound round({.number = number,
                          .seed = seed * 100 + static_cast<std::uint64_t>(number),
                          .minutes = options.minutes / rounds,
                          .pty = number % 2 == 0,
                          .only = options.only,
                          .means = means,
                          .neighbour = neighbour.get(),
                          .folder = folder / fmt::format("round-{}", number)});
      round.run(deck, results, goals);
    }
  } catch (const Interrupted&) {
    interrupted = true;
  }
  fmt::print("\n{}", to_table(results, goals));
  if (!options.report.empty()) {
    write_whole_file(options.report, to_json(results, goals, seed, options.minutes));
  }
  const bool good = passed(results, goals);
  fmt::print("{}\n", interrupted ? "interrupted" : (good ? "passed" : "FAILED"));
  return interrupted ? 130 : (good ? 0 : 1);
}

int run(int argc, char** argv) {
  Options options;
  CommandLine line(
      "torture",
      "Kills, freezes and restarts every process, pulls plugs, fills the disk and lets services leak while "
      "the simulated robot drives among boxes and people; judged by the simulator's truth.");
  line.number("--minutes", options.minutes, "[min] of driving; half of it with the robot on TCP, half on a terminal")
      .integer("--seed", options.seed, "of worlds and faults")
      .output_file("--report", options.report, "write every fault there (JSON)")
      .text("--only", options.only, "only faults whose name holds this, such as \"kill controller\"")
      .text("--keep", options.keep, "folder for logs and states, instead of a temporary one");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  catch_interrupts();
  const std::filesystem::path folder = make_folder(options.keep);
  const int status = torture(options, folder);
  if (options.keep.empty()) {
    std::filesystem::remove_all(folder);
  }
  return status;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  return luminav::run_guarded("torture", [&] { return luminav::run(argc, argv); });
}
