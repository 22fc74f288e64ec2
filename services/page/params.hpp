// Config of the page process (page.txtpb) as checked values.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lookout::page {

/// Where viewers of Foxglove's protocol are served.
struct FoxgloveParams {
  std::string bind_address = "127.0.0.1";  // numeric
  int port = 8765;
  std::vector<std::string> allowed_origins = {};
  int max_clients = 4;
};

struct Params {
  std::string boat;                        // the boat's name, as in boat.txtpb
  std::string bind_address = "127.0.0.1";  // numeric
  int port = 7668;
  std::vector<std::string> host_names = {};
  int max_clients = 16;
  bool allows_acknowledgements = true;
  std::filesystem::path token_file = {};    // empty: in the state folder
  std::filesystem::path map_file = {};      // empty: no map
  std::chrono::minutes look_back{10};       // 0: none
  std::filesystem::path spool_folder = {};  // empty: in the state folder
  std::int64_t spool_max_bytes = 2'000'000'000;
  std::optional<std::filesystem::path> recorder_folder =
      {};  // the recorder's folder, whose growing log is read instead of a spool; absolute, or relative to the working folder
  std::optional<std::filesystem::path> log_folder = {};  // the recorder's folder, whether its log is read or not
  std::int64_t reserve_bytes = 1'000'000'000;            // of the recorder's disk, which the spool leaves free, too
  std::optional<FoxgloveParams> foxglove = {};           // nullopt: no server for Foxglove's protocol
};

/// @param config_folder  the boat's folder, holding boat.txtpb, recorder.txtpb (for its log_folder and reserve_bytes) and page.txtpb
/// @throws config::ConfigError
Params LoadParams(const std::filesystem::path& config_folder);

/// Whether browsers of other computers reach the page.
bool IsForOthers(const std::string& bind_address);

/// Who can see the picture of a page there, as a part of a sentence: "this computer alone (127.0.0.1)".
std::string WhoSees(const std::string& bind_address);

/// The words of --check besides the values: who sees the picture, and who can acknowledge.
std::string InWords(const Params& params);

/// Where a browser of this computer finds the page: "http://localhost:7668/".
std::string AddressOnThisComputer(const std::string& bind_address, int port);

/// Where other computers find the page: an address for each of this computer's networks; with a loopback address none.
std::vector<std::string> AddressesForOthers(const std::string& bind_address, int port);

}  // namespace lookout::page
