// Checks the sources in lidar.txtpb as far as possible before any is opened, and opens them. For main and lookout-doctor.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "common/io/udp_receiver.hpp"
#include "common/runtime/source_reader.hpp"
#include "services/lidar/io/live_capture.hpp"
#include "services/lidar/params.hpp"
#include "services/lidar/service.hpp"

namespace lookout::lidar {

/// LoadParams, and besides that addresses are addresses, the filter compiles and captures can be read.
///
/// @param config_folder  the boat's folder, holding lidar.txtpb
/// @param number         2: of the second lidar, whose mounting boat.txtpb must have
/// @throws config::ConfigError with all faults; where fields break the schema, with these faults alone
Params LoadChecked(const std::filesystem::path& config_folder, int number = 1);

/// Options of source UDP. Precondition: LoadChecked.
io::UdpOptions ToUdpOptions(const Sources& sources, int port, const std::string& name = {});

/// Options of source INTERFACE. Precondition: LoadChecked.
LiveOptions ToLiveOptions(const Params& params);

/// Opens the sources for `service`, which must live longer, and logs what is worth knowing of them. Precondition: LoadChecked.
///
/// @return nullptr for source LOG: the service reads the bus alone
/// @throws std::runtime_error when one cannot be opened
std::unique_ptr<runtime::SourceReader> OpenSources(const Params& params, Service& service);

/// Opens the sources of `next` beside those that run, and closes them. @throws std::runtime_error when one cannot be opened
void TrySources(const Params& next, const Params& running);

}  // namespace lookout::lidar
