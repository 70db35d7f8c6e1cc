#include "drivers/simulator/people/people.hpp"

#include <gtest/gtest.h>

#include "tests/unit/simulator/text_world.hpp"

namespace luminav {
namespace {

/// A hall that is free from 0.5 to 10.5 and from 0.5 to 6.5, the robot in its middle, and one who walks along the wall.
class PeopleTest : public ::testing::Test {
 protected:
  PeopleTest() { truth_.people = {{{{1.0, 5.5}, {9.0, 5.5}}, 0.8}}; }

  void SetUp() override {
    scene_.emplace(truth_);
    people_.emplace(truth_.people, *scene_);
  }
  [[nodiscard]] RobotAmongPeople robot(bool carried = false) const { return {footprint_, pose_, carried}; }
  void step(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(100.0 * seconds)); ++i) {
      people_->step(0.01, robot());
    }
  }

  Pose2 pose_{5.0, 3.0, 0.0};
  WorldTruth truth_ = exact_truth(map_from_text(hall(20, 12)), pose_);
  Polygon footprint_ = transform(pose_, truth_.robot.footprint);
  std::optional<Scene> scene_;
  std::optional<People> people_;
};

TEST_F(PeopleTest, AreInTheSceneWhereTheyWalk) {
  step(2.0);
  ASSERT_EQ(scene_->people().size(), 1U);
  EXPECT_NEAR(scene_->people()[0].centre.x(), 2.6, 0.01);
}

TEST_F(PeopleTest, ComeUpBehindTheRobotAndGo) {
  EXPECT_EQ(people_->visitor(), nullptr);
  ASSERT_TRUE(people_->add_visitor({}, robot()));
  ASSERT_EQ(scene_->people().size(), 2U);
  EXPECT_NEAR(scene_->people()[1].centre.x(), 5.0 - 1.3, 1e-9);
  EXPECT_NE(people_->visitor(), nullptr);
  people_->remove_bystanders();
  EXPECT_EQ(scene_->people().size(), 2U);
  people_->remove_visitors();
  EXPECT_EQ(people_->visitor(), nullptr);
  EXPECT_EQ(scene_->people().size(), 1U);
}

TEST_F(PeopleTest, DoNotStandWhereTheRobotDoesUnlessItIsCarried) {
  EXPECT_FALSE(people_->add_bystander(pose_.position(), robot()));
  EXPECT_TRUE(people_->add_bystander(pose_.position(), robot(true)));
  EXPECT_EQ(people_->visitor(), nullptr) << "he follows nobody";
  step(1.0);
  EXPECT_EQ(scene_->people()[1].centre, pose_.position());
}

TEST_F(PeopleTest, DoNotStandInWalls) {
  EXPECT_FALSE(people_->add_bystander({0.3, 3.0}, robot()));
}

}  // namespace
}  // namespace luminav
