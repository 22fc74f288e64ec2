#include "services/navigator/io/gpsd_client.hpp"

#include <fcntl.h>
#include <gps.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string_view>

namespace lookout::navigator {

struct GpsdClient::Library {
  gps_data_t data{};
  bool is_open = false;
};

GpsdClient::GpsdClient(const std::string& name, const std::string& address, int port)
    : TcpClient(name, address, port, "gpsd"), library_(std::make_unique<Library>()) {}

GpsdClient::~GpsdClient() { CloseNow(); }

// libgps connects by itself and waits for it, minutes where nobody answers. So the connection that was made without waiting tells that gpsd is
// there; then the library's takes its place.
int GpsdClient::OnConnected(int, std::string& fault) {
  auto& data = library_->data;
  data = gps_data_t{};
  if (gps_open(address_.c_str(), port_.c_str(), &data) != 0) {
    fault = gps_errstr(errno);
    return kNone;
  }
  const int descriptor = static_cast<int>(data.gps_fd);
  const bool is_watched = gps_stream(&data, WATCH_ENABLE | WATCH_NMEA, nullptr) == 0;
  const int flags = fcntl(descriptor, F_GETFL);
  if (!is_watched || flags < 0 || fcntl(descriptor, F_SETFL, flags | O_NONBLOCK) < 0 || fcntl(descriptor, F_SETFD, FD_CLOEXEC) < 0) {
    fault = "does not take the command to send sentences";
    gps_close(&data);
    return kNone;
  }
  library_->is_open = true;
  return descriptor;
}

StreamSource::Result GpsdClient::Read(int, std::vector<std::uint8_t>& bytes) {
  // gpsd's own reports, of up to 10240 characters, are cut here, and are not used.
  constexpr std::size_t kMaxMessage = 512;
  // Between two sentences come some reports (version, devices).
  constexpr int kMaxReports = 16;
  for (int i = 0; i < kMaxReports; ++i) {
    std::array<char, kMaxMessage> message{};
    errno = 0;
    const int result = gps_read(&library_->data, message.data(), static_cast<int>(message.size()));
    const std::string_view line(message.data());
    if (result < 0 && line.empty()) return Result::kEnd;
    if (line.empty()) return Result::kNothing;
    if (line.front() == '{') continue;
    bytes.insert(bytes.end(), line.begin(), line.end());
    bytes.push_back('\n');
    return Result::kSome;
  }
  return Result::kNothing;
}

void GpsdClient::Close(int descriptor) {
  if (!library_->is_open) return TcpClient::Close(descriptor);
  gps_close(&library_->data);
  library_->is_open = false;
}

}  // namespace lookout::navigator
