#include "services/common/tours/tour_edit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/common/configuration/configuration_error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kTours = R"(# Ours.
home = "dock"        # never the lift

# for guests
[[tour]]
name = "morning"
at = "9:30"          # after the post
days = "Mo-Fr"
# its view
[[tour.stop]]
place = "lift"
pause = 20           # s
text = "The lift."

[[tour.stop]]
place = "dock"

[[tour]]
name = "round"
[[tour.stop]]
place = "dock"
# the end
)";

JobsSource source_of(const std::string& toml) {
  const TemporaryFolder folder;
  Building building;
  building.name = "laboratory";
  building.places = {{"lift", {}, true}, {"dock", {}, true}, {"door", {}, true}};
  return read_jobs_source(folder.write("jobs.toml", toml), building);
}

/// The text after an edit, which must say what the edit means.
std::string edited(const TourEdit& edit, const std::string& toml = kTours) {
  const JobsSource source = source_of(toml);
  const std::string text = with_edit(toml, source, edit);
  const JobsSource after = source_of(text);
  EXPECT_TRUE(are_same_tours(after.jobs.tours, with_edit(source.jobs.tours, edit))) << text;
  EXPECT_EQ(after.jobs.home, source.jobs.home);
  return text;
}

Tour tour(std::size_t index) {
  return source_of(kTours).jobs.tours[index];
}

std::string replaced(std::string text, const std::string& old, const std::string& by) {
  text.replace(text.find(old), old.size(), by);
  return text;
}

std::string complaint(const TourEdit& edit) {
  try {
    with_edit(tour(0).stops.empty() ? std::vector<Tour>{} : source_of(kTours).jobs.tours, edit);
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "none";
}

TEST(TourEdit, ChangesAKeyAndLeavesAllElse) {
  Tour changed = tour(0);
  changed.at = 36'000;
  EXPECT_EQ(edited({.name = "morning", .tour = changed}),
            replaced(kTours, "at = \"9:30\"          #", "at = \"10:00\"  #"))
      << "a comment of the line stays two blanks behind it";
}

TEST(TourEdit, WritesNothingThatIsAsItWas) {
  EXPECT_EQ(edited({.name = "morning", .tour = tour(0)}), kTours) << "also a time that somebody wrote his own way";
}

TEST(TourEdit, KeepsTheLinesOfStopsThatMove) {
  Tour turned = tour(0);
  std::swap(turned.stops[0], turned.stops[1]);
  const std::string text = edited({.name = "morning", .tour = turned});
  EXPECT_THAT(text, HasSubstr("# its view\n[[tour.stop]]\nplace = \"lift\"\npause = 20           # s"));
  EXPECT_LT(text.find("place = \"dock\""), text.find("# its view"));
}

TEST(TourEdit, AddsAndRemovesStops) {
  Tour longer = tour(0);
  longer.stops.insert(longer.stops.begin() + 1, {"door", 2.5, "A \"door\".", true});
  const std::string text = edited({.name = "morning", .tour = longer});
  EXPECT_THAT(text, HasSubstr("place = \"door\"\npause = 2.5\ntext = \"A \\\"door\\\".\"\nphoto = true\n"));
  EXPECT_THAT(text, HasSubstr("pause = 20           # s"));
  Tour shorter = tour(0);
  shorter.stops.erase(shorter.stops.begin());
  EXPECT_THAT(edited({.name = "morning", .tour = shorter}), HasSubstr("# its view"));
}

TEST(TourEdit, KeepsWhatIsSaidOfAStopThatGetsAnotherPlace) {
  Tour changed = tour(0);
  changed.stops[0].place = "door";
  EXPECT_THAT(edited({.name = "morning", .tour = changed}), HasSubstr("place = \"door\"\npause = 20           # s"));
}

TEST(TourEdit, TakesAwayWhatIsTheDefault) {
  Tour changed = tour(0);
  changed.at.reset();
  changed.days = kEveryDay;
  changed.stops[0].pause = 0.0;
  changed.stops[0].text = "";
  const std::string text = edited({.name = "morning", .tour = changed});
  for (const char* key : {"at =", "days", "pause", "text"}) {
    EXPECT_THAT(text, Not(HasSubstr(key)));
  }
}

TEST(TourEdit, AppendsANewOne) {
  const Tour night{.name = "night", .stops = {{"lift", 0.0, ""}}, .at = 0, .days = *read_days("Sa,Su")};
  EXPECT_EQ(edited({.tour = night}),
            std::string(kTours) +
                "\n[[tour]]\nname = \"night\"\nat = \"00:00\"\ndays = \"Sa,Su\"\n[[tour.stop]]\nplace = \"lift\"\n");
  EXPECT_EQ(edited({.tour = night}, ""),
            "\n[[tour]]\nname = \"night\"\nat = \"00:00\"\ndays = \"Sa,Su\"\n[[tour.stop]]\nplace = \"lift\"\n");
}

TEST(TourEdit, RemovesATourAlone) {
  const std::string text = edited({.kind = TourEdit::Kind::kRemove, .name = "morning"});
  for (const char* kept : {"# Ours.", "# never the lift", "# for guests", "# its view", "# the end", "round"}) {
    EXPECT_THAT(text, HasSubstr(kept));
  }
  EXPECT_THAT(text, Not(HasSubstr("morning")));
}

TEST(TourEdit, MovesATourWithWhatIsSaidOfIt) {
  const TourEdit forward{.kind = TourEdit::Kind::kMove, .name = "round", .before = "morning"};
  const std::string text = edited(forward);
  EXPECT_LT(text.find("round"), text.find("# for guests\n[[tour]]\nname = \"morning\""));
  EXPECT_EQ(edited({.kind = TourEdit::Kind::kMove, .name = "round"}, text).find("# Ours."), 0U);
  EXPECT_LT(edited({.kind = TourEdit::Kind::kMove, .name = "morning"}).find("round"),
            edited({.kind = TourEdit::Kind::kMove, .name = "morning"}).find("# for guests"));
}

TEST(TourEdit, RefusesWhatIsNotThereAndWhatIsThereAlready) {
  EXPECT_THAT(complaint({.name = "noon", .tour = tour(0)}), HasSubstr("no tour \"noon\""));
  EXPECT_THAT(complaint({.tour = tour(0)}), HasSubstr("a tour \"morning\" already"));
  EXPECT_THAT(complaint({.name = "round", .tour = tour(0)}), HasSubstr("a tour \"morning\" already"));
  EXPECT_THAT(complaint({.kind = TourEdit::Kind::kMove, .name = "round", .before = "noon"}), HasSubstr("no tour"));
  EXPECT_THAT(complaint({.kind = TourEdit::Kind::kMove, .name = "round", .before = "round"}), HasSubstr("itself"));
}

TEST(TourEdit, SaysWhereAFileIsWrittenAnotherWay) {
  const std::string inline_stops = "[[tour]]\nname = \"t\"\nstop = [{place = \"lift\"}]\n";
  Tour changed{.name = "t", .stops = {{"door", 0.0, ""}}};
  EXPECT_THROW(with_edit(inline_stops, source_of(inline_stops), TourEdit{.name = "t", .tour = changed}),
               ConfigurationError);
}

}  // namespace
}  // namespace luminav
