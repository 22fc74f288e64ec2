// A serial port without a cable: both ends of a pseudo terminal.
#pragma once

#include <poll.h>
#include <pty.h>
#include <unistd.h>

#include <filesystem>
#include <gtest/gtest.h>
#include <string>

namespace lookout::support {

/// The end of the cable; `device` is what a program opens.
struct PseudoTerminal {
  int cable = -1;
  std::string device;

  PseudoTerminal() {
    int end = -1;
    char name[64] = {};
    if (openpty(&cable, &end, name, nullptr, nullptr) == 0) close(end);
    device = name;
  }
  ~PseudoTerminal() { Unplug(); }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  /// What udev does when an adapter is plugged in: the same name, another device.
  void PlugInAs(const std::filesystem::path& name) const {
    std::filesystem::remove(name);
    std::filesystem::create_symlink(device, name);
  }
  void Unplug() {
    if (cable >= 0) close(cable);
    cable = -1;
  }
  void Write(const std::string& text) const { EXPECT_EQ(write(cable, text.data(), text.size()), static_cast<ssize_t>(text.size())); }
  /// What has come.
  std::string Read() const {
    std::string text;
    char bytes[4096];
    for (pollfd waiting{cable, POLLIN, 0}; poll(&waiting, 1, 0) > 0 && (waiting.revents & POLLIN) != 0;) {
      const auto size = read(cable, bytes, sizeof bytes);
      if (size <= 0) break;
      text.append(bytes, static_cast<std::size_t>(size));
    }
    return text;
  }
};

}  // namespace lookout::support
