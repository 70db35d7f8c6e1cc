#include "services/viewer/building/building_order.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/viewer/http/request_fields.hpp"

namespace luminav {
namespace {

using testing::HasSubstr;

std::string objection_to(const std::string& body) {
  try {
    read_building_order(body);
    return "";
  } catch (const RequestError& error) {
    return error.what();
  }
}

std::string zone_order(const std::string& zone) {
  return R"({"version":"1","action":"set_zone","zone":)" + zone + "}";
}

TEST(BuildingOrder, ReadsAZoneWithItsRule) {
  const BuildingOrder order = read_building_order(
      R"({"version":"1f","action":"set_zone","name":"old","accept":true,"zone":{"name":"new","kind":"one-way",)"
      R"("polygon":[[0,0],[1,0],[1,1]],"direction":3.5}})");
  EXPECT_EQ(order.version, "1f");
  EXPECT_TRUE(order.accepts);
  EXPECT_FALSE(order.undoes);
  EXPECT_EQ(order.edit.kind, BuildingEdit::Kind::kSetZone);
  EXPECT_EQ(order.edit.name, "old");
  EXPECT_EQ(order.edit.zone.kind, ZoneKind::kOneWay);
  EXPECT_NEAR(order.edit.zone.direction, 3.5 - 2.0 * kPi, 1e-12);
  EXPECT_EQ(order.edit.zone.polygon.size(), 3U);
}

TEST(BuildingOrder, ReadsTheHoursOfAZone) {
  const std::string zone = R"({"name":"a","kind":"quiet","polygon":[[0,0],[1,0],[1,1]])";
  EXPECT_TRUE(are_always(read_building_order(zone_order(zone + "}")).edit.zone.hours));
  EXPECT_EQ(read_building_order(zone_order(zone + R"(,"hours":"22:00-06:00","days":"Fr"})")).edit.zone.hours,
            (Hours{22 * 3600, 6 * 3600, *read_days("Fr")}));
  EXPECT_THAT(objection_to(zone_order(zone + R"(,"hours":"25:00-26:00"})")), HasSubstr("hours: must be two times"));
  EXPECT_THAT(objection_to(zone_order(zone + R"(,"days":"Di"})")), HasSubstr("days: must be days as Mo-Fr"));
}

TEST(BuildingOrder, ReadsPlacesRemovalsAndAnUndo) {
  const BuildingOrder place =
      read_building_order(R"({"version":"1","action":"set_place","place":{"name":"lift","x":1.5,"y":2}})");
  EXPECT_EQ(place.edit.place.name, "lift");
  EXPECT_FALSE(place.edit.place.has_theta);
  EXPECT_EQ(read_building_order(R"({"version":"1","action":"remove_place","name":"lift"})").edit.kind,
            BuildingEdit::Kind::kRemovePlace);
  EXPECT_TRUE(read_building_order(R"({"version":"1","action":"undo"})").undoes);
}

TEST(BuildingOrder, RefusesWhatIsNoZone) {
  const std::string square = R"("polygon":[[0,0],[1,0],[1,1],[0,1]])";
  EXPECT_EQ(objection_to(zone_order(R"({"name":"a","kind":"quiet",)" + square + "}")), "");
  EXPECT_THAT(objection_to(zone_order(R"({"name":"","kind":"quiet",)" + square + "}")), HasSubstr("name"));
  EXPECT_THAT(objection_to(zone_order(R"({"name":"a\nb","kind":"quiet",)" + square + "}")), HasSubstr("name"));
  EXPECT_THAT(objection_to(zone_order(R"({"name":"a","kind":"lava",)" + square + "}")), HasSubstr("keep-out, slow"));
  EXPECT_THAT(objection_to(zone_order(R"({"name":"a","kind":"slow",)" + square + "}")), HasSubstr("speed"));
  EXPECT_THAT(objection_to(zone_order(R"({"name":"a","kind":"one-way",)" + square + "}")), HasSubstr("direction"));
  EXPECT_THAT(objection_to(zone_order(R"({"name":"a","kind":"quiet","polygon":[[0,0],[1,1]]})")),
              HasSubstr("3 to 100 corners"));
  EXPECT_THAT(objection_to(zone_order(R"({"name":"a","kind":"quiet","polygon":[[0,0],[1,1],[1,0],[0,1]]})")),
              HasSubstr("must not cross"));
  EXPECT_THAT(objection_to(zone_order(R"({"name":"a","kind":"quiet","polygon":[[0,0],[1,1],[1,null]]})")),
              HasSubstr("y: must be a number"));
  EXPECT_THAT(objection_to(R"({"version":"1","action":"set_zone"})"), HasSubstr("zone: is missing"));
  EXPECT_THAT(objection_to(R"({"version":"1","action":"remove_zone"})"), HasSubstr("name"));
  EXPECT_THAT(objection_to(R"({"action":"undo"})"), HasSubstr("version"));
}

TEST(RequestFields, NameTheKeyAndWhatIsAllowed) {
  const nlohmann::json object = {{"speed", 3.0}, {"name", 1}, {"kind", "slow"}};
  EXPECT_EQ(choice(object, "kind", {"keep-out", "slow"}), 1);
  const auto why = [](const auto& read) -> std::string {
    try {
      read();
      return "";
    } catch (const RequestError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(why([&] { number(object, "speed", 0.0, 2.0); }), "speed: must be 0 to 2");
  EXPECT_EQ(why([&] { text(object, "name"); }), "name: must be a text");
  EXPECT_EQ(why([&] { boolean(object, "on"); }), "on: must be true or false");
  EXPECT_EQ(why([&] { check_item(object, "zone", {"name", "kind"}); }), "zone: known keys are name, kind");
}

}  // namespace
}  // namespace luminav
