#include "services/caretaker/lamp_report.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <ctime>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>

#include "services/caretaker/shared_switches.hpp"

namespace luminav {
namespace {

constexpr std::size_t kMaxNamed = 3;  // partners in one sentence
constexpr int kFlickerVisits = 4;     // of which two must show it: one may have looked at the wrong moments
constexpr int kMinFlickerVisits = 2;

/// The newest visits for which `is_so` holds, as far back as no visit says the opposite; those that say nothing are
/// passed over.
std::vector<FixtureVisit> last_spell(const std::vector<FixtureVisit>& visits,
                                     const std::function<std::optional<bool>(const FixtureVisit&)>& is_so) {
  std::vector<FixtureVisit> spell;
  for (auto visit = visits.rbegin(); visit != visits.rend(); ++visit) {
    const std::optional<bool> says = is_so(*visit);
    if (says && !*says) {
      break;
    }
    if (says) {
      spell.push_back(*visit);
    }
  }
  std::reverse(spell.begin(), spell.end());
  return spell;
}

/// Of a spell, the visits during which a lamp of the same switch burnt wholly, and which lamps those were.
struct Witnessed {
  int visits = 0;
  std::int64_t since = 0;  // [us]
  std::vector<int> partners;
};

Witnessed count_witnessed(const LampLedger& ledger, const std::vector<FixtureVisit>& spell,
                          const std::vector<int>& partners) {
  Witnessed witnessed;
  for (const FixtureVisit& mine : spell) {
    bool is_witnessed = false;
    for (const int partner : partners) {
      const std::vector<FixtureVisit>& others = ledger.visits(partner);
      if (std::any_of(others.begin(), others.end(), [&](const FixtureVisit& other) {
            return are_together(mine, other) && was_burning(other).value_or(false) && !was_half_lit(other);
          })) {
        is_witnessed = true;
        witnessed.partners.push_back(partner);
      }
    }
    if (is_witnessed) {
      witnessed.since = witnessed.visits == 0 ? mine.begin : witnessed.since;
      ++witnessed.visits;
    }
  }
  std::sort(witnessed.partners.begin(), witnessed.partners.end());
  witnessed.partners.erase(std::unique(witnessed.partners.begin(), witnessed.partners.end()), witnessed.partners.end());
  return witnessed;
}

std::optional<LampFinding> judge_spell(const LampLedger& ledger, const std::vector<Fixture>& fixtures, int id,
                                       LampCondition condition, const std::vector<FixtureVisit>& spell) {
  if (static_cast<int>(spell.size()) < kMinVisits) {
    return std::nullopt;
  }
  const Witnessed witnessed =
      count_witnessed(ledger, spell, switch_partners(ledger, fixtures, id, spell.front().begin));
  if (witnessed.visits < kMinVisits) {
    return std::nullopt;
  }
  return LampFinding{id, condition, witnessed.since, witnessed.visits, witnessed.partners};
}

/// Judges by the newest visits with the lamp switched on.
std::optional<LampFinding> judge_flicker(int id, const std::vector<FixtureVisit>& visits) {
  LampFinding finding{id, LampCondition::kFlickers, 0, 0, {}};
  int looked = 0;
  for (auto visit = visits.rbegin(); visit != visits.rend() && looked < kFlickerVisits; ++visit) {
    if (was_flickering(*visit)) {
      ++finding.visits;
      finding.since = visit->begin;
    }
    looked += was_flickering(*visit) || was_burning(*visit) != false ? 1 : 0;
  }
  return finding.visits >= kMinFlickerVisits ? std::optional(finding) : std::nullopt;
}

LampFinding judge(const LampLedger& ledger, const std::vector<Fixture>& fixtures, int id) {
  const std::vector<FixtureVisit>& visits = ledger.visits(id);
  if (visits.empty()) {
    return {id, LampCondition::kUnseen, 0, 0, {}};
  }
  const auto dark = last_spell(visits, [](const FixtureVisit& visit) -> std::optional<bool> {
    const std::optional<bool> burns = was_burning(visit);
    return burns ? std::optional(!*burns) : std::nullopt;
  });
  if (const auto finding = judge_spell(ledger, fixtures, id, LampCondition::kDark, dark)) {
    return *finding;
  }
  if (static_cast<int>(dark.size()) >= kMinVisits &&
      switch_partners(ledger, fixtures, id, dark.front().begin).empty()) {
    return {id, LampCondition::kUnjudged, dark.front().begin, static_cast<int>(dark.size()), {}};
  }
  if (const auto finding = judge_flicker(id, visits)) {
    return *finding;
  }
  const auto half = last_spell(visits, [](const FixtureVisit& visit) -> std::optional<bool> {
    return was_burning(visit).value_or(false) ? std::optional(was_half_lit(visit)) : std::nullopt;
  });
  if (const auto finding = judge_spell(ledger, fixtures, id, LampCondition::kPartlyDark, half)) {
    return *finding;
  }
  return {id, LampCondition::kGood, visits.back().begin, static_cast<int>(visits.size()), {}};
}

std::string date(std::int64_t utime) {
  return fmt::format("{:%a %d %b %Y, %H:%M}", fmt::localtime(static_cast<std::time_t>(utime / 1'000'000)));
}

std::string ids(const std::vector<int>& partners) {
  const std::size_t named = std::min(kMaxNamed, partners.size());
  const std::vector<int> first(partners.begin(), partners.begin() + static_cast<std::ptrdiff_t>(named));
  const std::size_t others = partners.size() - named;
  return others == 0 ? fmt::format("{}", fmt::join(first, ", "))
                     : fmt::format("{} and {} others", fmt::join(first, ", "), others);
}

std::string place_of(int id, const Building& building) {
  const auto fixture =
      std::find_if(building.fixtures.begin(), building.fixtures.end(), [id](const Fixture& f) { return f.id == id; });
  if (fixture == building.fixtures.end()) {
    return "gone from the file";
  }
  const Pose2& pose = fixture->world_from_fixture;
  const auto nearest =
      std::min_element(building.places.begin(), building.places.end(),
                       [&](const Place& a, const Place& b) { return distance(a.pose, pose) < distance(b.pose, pose); });
  return nearest == building.places.end() ? fmt::format("at ({:.1f}, {:.1f})", pose.x, pose.y)
                                          : fmt::format("at ({:.1f}, {:.1f}), {:.0f} m from {}", pose.x, pose.y,
                                                        distance(nearest->pose, pose), nearest->name);
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char letter : text) {
    out += letter == '&' ? "&amp;" : letter == '<' ? "&lt;" : letter == '>' ? "&gt;" : std::string(1, letter);
  }
  return out;
}

bool is_fault(const LampFinding& finding) {
  return finding.condition >= LampCondition::kFlickers;
}

int count(const std::vector<LampFinding>& findings, LampCondition condition) {
  return static_cast<int>(
      std::count_if(findings.begin(), findings.end(), [&](const LampFinding& f) { return f.condition == condition; }));
}

std::string summary(const std::vector<LampFinding>& findings) {
  return fmt::format("{} fixtures: {} good, {} dark, {} partly dark, {} flicker, {} not judged, {} not seen",
                     findings.size(), count(findings, LampCondition::kGood), count(findings, LampCondition::kDark),
                     count(findings, LampCondition::kPartlyDark), count(findings, LampCondition::kFlickers),
                     count(findings, LampCondition::kUnjudged), count(findings, LampCondition::kUnseen));
}

}  // namespace

const char* name_of(LampCondition condition) {
  switch (condition) {
    case LampCondition::kUnseen:
      return "not seen";
    case LampCondition::kGood:
      return "good";
    case LampCondition::kUnjudged:
      return "not judged";
    case LampCondition::kFlickers:
      return "flickers";
    case LampCondition::kPartlyDark:
      return "partly dark";
    case LampCondition::kDark:
      return "dark";
  }
  return "";
}

std::vector<LampFinding> judge_lamps(const LampLedger& ledger, const std::vector<Fixture>& fixtures) {
  std::vector<LampFinding> findings;
  for (const Fixture& fixture : fixtures) {
    findings.push_back(judge(ledger, fixtures, fixture.id));
  }
  return findings;
}

std::string describe(const LampFinding& finding, const Building& building) {
  const std::string head = fmt::format("fixture {} {}: ", finding.id, place_of(finding.id, building));
  switch (finding.condition) {
    case LampCondition::kUnseen:
      return head + "not seen yet";
    case LampCondition::kGood:
      return head + fmt::format("good, seen last {}", date(finding.since));
    case LampCondition::kUnjudged:
      return head + fmt::format("dark since {}, {} visits; which lamps share its switch is not known",
                                date(finding.since), finding.visits);
    case LampCondition::kFlickers:
      return head + fmt::format("flickers since {}, {} visits", date(finding.since), finding.visits);
    case LampCondition::kPartlyDark:
    case LampCondition::kDark:
      return head + fmt::format("{} since {}, {} visits while {} of its switch burnt", name_of(finding.condition),
                                date(finding.since), finding.visits, ids(finding.partners));
  }
  return head;
}

std::string lamps_text(const std::vector<LampFinding>& findings, const Building& building) {
  std::string text;
  for (const LampFinding& finding : findings) {
    if (is_fault(finding)) {
      text += describe(finding, building) + "\n";
    }
  }
  return text + summary(findings) + "\n";
}

std::string lamps_html(const std::vector<LampFinding>& findings, const Building& building) {
  std::string rows;
  for (const LampFinding& finding : findings) {
    rows += fmt::format("<tr{}><td>{}</td><td>{}</td><td>{}</td></tr>\n", is_fault(finding) ? " class=\"fault\"" : "",
                        finding.id, name_of(finding.condition), escaped(describe(finding, building)));
  }
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\">\n<title>Lamps of {0}</title>\n"
      "<style>body{{font:16px sans-serif;margin:2em auto;max-width:60em;padding:0 1em}}"
      "table{{border-collapse:collapse;width:100%}}td,th{{text-align:left;padding:.4em .6em;border-bottom:1px solid "
      "#ccc}}.fault{{background:#fff1c2}}</style>\n<h1>Lamps of {0}</h1>\n<p>{1}</p>\n"
      "<table><tr><th>Fixture</th><th>Condition</th><th>What was seen</th></tr>\n{2}</table>\n</html>\n",
      escaped(building.name), summary(findings), rows);
}

std::string lamps_csv(const std::vector<LampFinding>& findings, const Building& building) {
  std::string text = "fixture,condition,since_utime_us,visits,sentence\n";
  for (const LampFinding& finding : findings) {
    std::string sentence = describe(finding, building);
    for (std::size_t at = 0; (at = sentence.find('"', at)) != std::string::npos; at += 2) {
      sentence.insert(at, 1, '"');
    }
    text += fmt::format("{},{},{},{},\"{}\"\n", finding.id, name_of(finding.condition), finding.since, finding.visits,
                        sentence);
  }
  return text;
}

std::string lamps_json(const std::vector<LampFinding>& findings, const Building& building) {
  nlohmann::json list = nlohmann::json::array();
  for (const LampFinding& finding : findings) {
    list.push_back({{"fixture", finding.id},
                    {"condition", name_of(finding.condition)},
                    {"since_utime_us", finding.since},
                    {"visits", finding.visits},
                    {"partners", finding.partners},
                    {"sentence", describe(finding, building)}});
  }
  return nlohmann::json{{"building", building.name}, {"lamps", list}}.dump(2) + "\n";
}

}  // namespace luminav
