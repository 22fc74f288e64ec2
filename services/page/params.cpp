#include "services/page/params.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <system_error>

#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "common/io/network.hpp"
#include "config/schema/page.pb.h"
#include "config/schema/recorder.pb.h"

namespace lookout::page {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kFile = "page.txtpb";

// RFC 1123: letters, digits, hyphens and dots.
bool IsHostName(const std::string& name) {
  constexpr std::size_t kMostBytes = 253;
  const auto is_letter = [](char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9') || letter == '-' || letter == '.';
  };
  return !name.empty() && name.size() <= kMostBytes && std::ranges::all_of(name, is_letter) && name.front() != '.' && name.front() != '-';
}

// As a browser sends it: a scheme, and a host with its port or (of files) none.
bool IsOrigin(const std::string& origin) {
  constexpr std::string_view kSeparator = "://";
  constexpr std::size_t kMostBytes = 300;
  const auto separator = origin.find(kSeparator);
  if (separator == std::string::npos || separator == 0 || origin.size() > kMostBytes) return false;
  const auto host = std::string_view(origin).substr(separator + kSeparator.size());
  return std::ranges::all_of(host, [](char letter) { return letter > ' ' && letter <= '~' && letter != '/' && letter != '*'; });
}

// In a URL.
std::string HostOf(const io::IpAddress& address) { return address.is_ipv4() ? io::ToText(address) : "[" + io::ToText(address) + "]"; }

bool IsLinkLocal(const io::IpAddress& address) {
  constexpr int kFirst = 0xFE;
  constexpr int kSecond = 0x80;
  constexpr int kMask = 0xC0;
  return address.bytes[0] == kFirst && (address.bytes[1] & kMask) == kSecond;
}

class Reader {
 public:
  Reader(fs::path folder, const config::Page& message) : folder_(std::move(folder)), message_(message) {}

  /// @throws config::ConfigError
  void ReadInto(Params& params) {
    params.bind_address = message_.bind_address();
    RequireAddress("bind_address", params.bind_address);
    params.port = message_.port();
    Require(message_.host_name_size() <= kMostNames, "host_name", fmt::format("at most {} names", kMostNames));
    for (const auto& name : message_.host_name()) {
      Require(IsHostName(name), "host_name", "'" + name + "' is no name of a computer: without http:// and port");
      params.host_names.push_back(name);
    }
    params.max_clients = message_.max_clients();
    params.allows_acknowledgements = message_.allows_acknowledgements();
    if (message_.has_token_file()) params.token_file = PathOf("token_file", message_.token_file());
    if (message_.has_map_file()) params.map_file = PathOf("map_file", message_.map_file());
    params.look_back = std::chrono::minutes(message_.look_back_minutes());
    if (message_.has_look_back_folder()) params.spool_folder = PathOf("look_back_folder", message_.look_back_folder());
    params.spool_max_bytes = message_.look_back_max_bytes();
    if (message_.has_foxglove()) params.foxglove = ReadFoxglove(message_.foxglove());
    if (!faults_.empty()) throw config::ConfigError(faults_);
  }

 private:
  static constexpr int kMostNames = 16;

  FoxgloveParams ReadFoxglove(const config::FoxgloveViewers& message) {
    FoxgloveParams params{.bind_address = message.bind_address(), .port = message.port(), .max_clients = message.max_clients()};
    RequireAddress("foxglove.bind_address", params.bind_address);
    Require(params.port != message_.port(), "foxglove.port", "must differ from port");
    Require(message.allowed_origin_size() <= kMostNames, "foxglove.allowed_origin", fmt::format("at most {} origins", kMostNames));
    for (const auto& origin : message.allowed_origin()) {
      Require(IsOrigin(origin), "foxglove.allowed_origin", "'" + origin + "' is no origin: https://HOST or http://HOST:PORT, without a path");
      params.allowed_origins.push_back(origin);
    }
    return params;
  }

  void RequireAddress(const std::string& field, const std::string& text) {
    const auto address = io::ParseIpAddress(text);
    Require(address.has_value(), field, "'" + text + "' is no numeric address");
    Require(!address || !address->is_multicast(), field, "'" + text + "' is no address of a computer");
  }
  void Require(bool is_right, const std::string& field, const std::string& reason) {
    if (!is_right) faults_.push_back(config::FaultLine(folder_ / kFile, field, reason));
  }
  fs::path PathOf(const std::string& field, const std::string& text) {
    Require(!text.empty(), field, "must not be empty: leave the line out");
    return folder_ / text;
  }

  fs::path folder_;
  const config::Page& message_;
  std::vector<std::string> faults_;
};

}  // namespace

Params LoadParams(const fs::path& config_folder) {
  config::FaultList faults;
  const auto boat = faults.Take([&] { return config::LoadBoat(config_folder); });
  Params params;
  bool follows_recorder = true;
  faults.Try([&] {
    const auto message = config::Load<config::Page>(config_folder, std::string(kFile));
    Reader(config_folder, message).ReadInto(params);
    follows_recorder = message.follows_recorder();
  });
  faults.ThrowIfAny();
  params.boat = boat->name;
  config::Recorder recorder;
  params.reserve_bytes = recorder.reserve_bytes();
  try {
    recorder = config::Load<config::Recorder>(config_folder, "recorder.txtpb");
    params.reserve_bytes = recorder.reserve_bytes();
    params.log_folder = recorder.log_folder();
    if (follows_recorder) params.recorder_folder = params.log_folder;
  } catch (const config::ConfigError&) {  // the recorder reports this fault
  }
  return params;
}

bool IsForOthers(const std::string& bind_address) {
  const auto address = io::ParseIpAddress(bind_address);
  return address && !io::IsLoopback(*address);
}

std::string WhoSees(const std::string& bind_address) {
  if (!IsForOthers(bind_address)) return "browsers of this computer alone (" + bind_address + ")";
  const auto address = io::ParseIpAddress(bind_address);
  if (address->is_any()) return "everybody in each network of this computer (" + bind_address + "), without a password";
  return "everybody in the network of " + bind_address + ", without a password";
}

std::string InWords(const Params& params) {
  std::string text = fmt::format("# page.txtpb: the picture is for {}, TCP port {}\n", WhoSees(params.bind_address), params.port);
  text += params.allows_acknowledgements ? "# page.txtpb: who has the token acknowledges alerts\n" : "# page.txtpb: nobody acknowledges alerts\n";
  if (params.foxglove) {
    text += fmt::format("# page.txtpb: Foxglove and Lichtblick see it, too: {}, TCP port {}\n", WhoSees(params.foxglove->bind_address),
                        params.foxglove->port);
  }
  return text;
}

std::string AddressOnThisComputer(const std::string& bind_address, int port) {
  const auto address = io::ParseIpAddress(bind_address);
  const bool is_local = !address || address->is_any() || bind_address == "127.0.0.1";
  return fmt::format("http://{}:{}/", is_local ? "localhost" : HostOf(*address), port);
}

std::vector<std::string> AddressesForOthers(const std::string& bind_address, int port) {
  std::vector<std::string> addresses;
  const auto bound = io::ParseIpAddress(bind_address);
  if (!bound || io::IsLoopback(*bound)) return addresses;
  // A browser takes no zone, without which an address of one link leads nowhere.
  for (const auto& address : bound->is_any() ? io::OwnAddresses() : std::vector{*bound}) {
    if (io::IsLoopback(address) || IsLinkLocal(address) || (bind_address == "0.0.0.0" && !address.is_ipv4())) continue;
    addresses.push_back(fmt::format("http://{}:{}/", HostOf(address), port));
  }
  return addresses;
}

}  // namespace lookout::page
