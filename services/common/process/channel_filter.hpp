#pragma once

#include <linux/filter.h>

#include <lcm/lcm-cpp.hpp>
#include <string>
#include <vector>

namespace luminav {

/// A socket filter (classic BPF, data begins with the UDP header) that keeps LCM's short messages on one of the
/// channels and, unread, whatever is not a short message. No channel keeps no short message.
[[nodiscard]] std::vector<sock_filter> make_channel_filter(const std::vector<std::string>& channels);

/// Lets the kernel drop what comes on other channels than these, before it wakes LCM's receiving thread: every process
/// gets all that is said on the network, and most of it is for others. To be called once all is subscribed. `url` as
/// given to open_lcm. Returns whether a socket was found to filter; without one all goes on, only dearer.
bool receive_only(lcm::LCM& lcm, const std::string& url, const std::vector<std::string>& channels);

}  // namespace luminav
