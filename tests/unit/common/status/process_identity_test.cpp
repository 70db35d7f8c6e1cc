#include "services/common/process/status/process_identity.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(ProcessIdentity, KnowsWhatItSaidItselfFromWhatItsTwinSays) {
  const ProcessIdentity self{"controller", "p3dx", "desk", 17};
  node_status_t status{};
  EXPECT_FALSE(self.has_said(status));
  self.sign(status);
  EXPECT_TRUE(self.has_said(status));
  ProcessIdentity{"controller", "p3dx", "desk", 18}.sign(status);
  EXPECT_FALSE(self.has_said(status));
}

}  // namespace
}  // namespace luminav
