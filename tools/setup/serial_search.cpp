#include "tools/setup/serial_search.hpp"

#include <algorithm>
#include <set>
#include <system_error>

namespace lookout::setup {

namespace fs = std::filesystem;

std::vector<fs::path> SerialDevices() {
  std::vector<fs::path> devices;
  std::set<fs::path> known;
  const auto look_in = [&](const fs::path& folder, const std::vector<std::string>& beginnings) {
    std::error_code error;
    std::vector<fs::path> found;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
      const auto name = entry->path().filename().string();
      const bool is_wanted = beginnings.empty() || std::ranges::any_of(beginnings, [&](const auto& begin) { return name.starts_with(begin); });
      if (is_wanted) found.push_back(entry->path());
    }
    std::ranges::sort(found);
    for (const auto& device : found) {
      std::error_code unused;
      if (known.insert(fs::weakly_canonical(device, unused)).second) devices.push_back(device);
    }
  };
  look_in("/dev/serial/by-id", {});
  look_in("/dev", {"ttyUSB", "ttyACM"});
  return devices;
}

void SerialSearch::Poll(Utime now, NmeaSurvey& survey) {
  if (!is_found_ && next_baud_ <= kBauds.size() && (!began_ || now - *began_ > kWait)) {
    port_.reset();
    began_ = now;
    if (next_baud_ < kBauds.size()) {
      survey.BeginSerial(device_.string());
      port_ = std::make_unique<navigator::SerialPort>("serial", device_, kBauds.at(next_baud_));
    }
    ++next_baud_;
  }
  if (!port_) return;
  port_->Poll(now);
  while (const auto piece = port_->Receive(now)) {
    if (piece->kind == io::Source::Kind::kBreak) continue;
    is_found_ |= survey.AddSerial(piece->host_time, device_.string(), kBauds.at(next_baud_ - 1), piece->bytes);
  }
  if (const auto fault = port_->fault(); !fault.empty()) fault_ = fault;
}

}  // namespace lookout::setup
