#include "services/viewer/building/tour_order.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "services/viewer/request_text.hpp"

namespace luminav {
namespace {

using testing::HasSubstr;

std::string objection_to(const std::string& body) {
  try {
    read_tour_order(body);
    return "";
  } catch (const RequestError& error) {
    return error.what();
  }
}

std::string tour_order(const std::string& tour) {
  return R"({"version":"1","action":"set_tour","tour":)" + tour + "}";
}

TEST(TourOrder, ReadsATourWithItsTimesAndStops) {
  const TourOrder order = read_tour_order(
      R"({"version":"1f","action":"set_tour","name":"old","accept":true,"tour":{"name":"new","at":"09:30",)"
      R"("days":["Mo","Su"],"stops":[{"place":"lift","pause":20,"text":"The lift."},{"place":"door"}]}})");
  EXPECT_EQ(order.version, "1f");
  EXPECT_TRUE(order.accepts);
  EXPECT_FALSE(order.undoes);
  EXPECT_EQ(order.edit.kind, TourEdit::Kind::kSet);
  EXPECT_EQ(order.edit.name, "old");
  EXPECT_EQ(order.edit.tour.at, 34'200);
  EXPECT_EQ(order.edit.tour.days, *read_days("Mo,Su"));
  ASSERT_EQ(order.edit.tour.stops.size(), 2U);
  EXPECT_EQ(order.edit.tour.stops[0].pause, 20.0);
  EXPECT_EQ(order.edit.tour.stops[1].text, "");
}

TEST(TourOrder, ReadsRemovalsMovesAndAnUndo) {
  const TourOrder moved = read_tour_order(R"({"version":"1","action":"move_tour","name":"noon","before":"morning"})");
  EXPECT_EQ(moved.edit.kind, TourEdit::Kind::kMove);
  EXPECT_EQ(moved.edit.before, "morning");
  EXPECT_EQ(read_tour_order(R"({"version":"1","action":"remove_tour","name":"noon"})").edit.kind,
            TourEdit::Kind::kRemove);
  EXPECT_TRUE(read_tour_order(R"({"version":"1","action":"undo"})").undoes);
}

TEST(TourOrder, RefusesWhatIsNoTour) {
  const std::string stops = R"("stops":[{"place":"lift"}])";
  EXPECT_EQ(objection_to(tour_order(R"({"name":"t",)" + stops + "}")), "");
  EXPECT_THAT(objection_to(tour_order(R"({"name":"",)" + stops + "}")), HasSubstr("name"));
  EXPECT_THAT(objection_to(tour_order(R"({"name":"t","stops":[]})")), HasSubstr("stops: must be a list of 1 to 20"));
  EXPECT_THAT(objection_to(tour_order(R"({"name":"t","at":"25:00",)" + stops + "}")), HasSubstr("as 09:30"));
  EXPECT_THAT(objection_to(tour_order(R"({"name":"t","days":["Monday"],)" + stops + "}")), HasSubstr("Mo, Tu"));
  EXPECT_THAT(objection_to(tour_order(R"({"name":"t","days":[],)" + stops + "}")), HasSubstr("days"));
  EXPECT_THAT(objection_to(tour_order(R"({"name":"t","stops":[{"place":"lift","pause":3601}]})")), HasSubstr("pause"));
  EXPECT_THAT(objection_to(tour_order(R"({"name":"t","stops":[{"place":"lift","text":"a\nb"}]})")),
              HasSubstr("one line of 200 bytes"));
  EXPECT_THAT(
      objection_to(tour_order(R"({"name":"t","stops":[{"place":"lift","text":")" + std::string(201, 'x') + R"("}]})")),
      HasSubstr("one line of 200 bytes"));
  EXPECT_THAT(objection_to(tour_order(R"({"name":"t","loop":true,)" + stops + "}")), HasSubstr("known keys"));
  EXPECT_THAT(objection_to(R"({"version":"1","action":"set_tour"})"), HasSubstr("tour: is missing"));
  EXPECT_THAT(objection_to(R"({"version":"1","action":"move_tour"})"), HasSubstr("name"));
  EXPECT_THAT(objection_to(R"({"action":"undo"})"), HasSubstr("version"));
}

TEST(TourOrder, ReadsTheToursThatItWrites) {
  const std::vector<Tour> tours = {{.name = "a \"b\"",
                                    .stops = {{"lift", 2.5, "ä", true}, {"door", 0.0, ""}},
                                    .at = 60,
                                    .days = *read_days("Tu-Th")},
                                   {.name = "c", .stops = {{"lift", 0.0, ""}}}};
  const auto written = nlohmann::json::parse(tours_json(tours));
  std::vector<Tour> read;
  for (const auto& tour : written) {
    read.push_back(read_tour_order(tour_order(tour.dump())).edit.tour);
  }
  EXPECT_TRUE(are_same_tours(read, tours));
}

}  // namespace
}  // namespace luminav
