#include "common/io/interface.hpp"

#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>

namespace lookout::io {

bool IsInterfaceUp(const std::string& interface) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return false;
  ifreq request{};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  const bool is_up = ioctl(descriptor, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
  close(descriptor);
  return is_up;
}

std::string NoInterfaceText(const std::string& interface) {
  std::string names;
  struct if_nameindex* const list = if_nameindex();
  for (auto* item = list; item != nullptr && item->if_index != 0; ++item) {
    names += names.empty() ? "" : ", ";
    names += item->if_name;
  }
  if (list != nullptr) if_freenameindex(list);
  return "there is no interface '" + interface + "' now (there are: " + names +
         "). When it comes late at boot, start after it; systemd: After=sys-subsystem-net-devices-" + interface + ".device";
}

bool InterfaceTimer::IsDue(Utime now) {
  // A clock that was set back makes no pause longer.
  if (now >= last_ && now - last_ < std::chrono::seconds(1)) return false;
  last_ = now;
  return true;
}

}  // namespace lookout::io
