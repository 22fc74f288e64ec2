// Network interfaces of this computer, by name ("eth0").
#pragma once

#include <string>

#include "common/core/utime.hpp"

namespace lookout::io {

bool IsInterfaceUp(const std::string& interface);

/// For errors: that it is not there, which ones there are, and what to do when it comes late at boot.
std::string NoInterfaceText(const std::string& interface);

/// Says when an interface is to be looked at: about once a second.
class InterfaceTimer {
 public:
  bool IsDue(Utime now);

 private:
  Utime last_{};
};

}  // namespace lookout::io
