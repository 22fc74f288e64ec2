// A whole log as an MCAP file: each message as it is, and what Foxglove and Lichtblick draw.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <vector>

#include "tools/export/export.hpp"

namespace lookout::exporter {

inline constexpr const char* kMcapFormat = "mcap";

/// Uses inputs, output, force and progress of the request alone.
///
/// Channels with the names of the log hold its messages as they are (message encoding x-lcm; the schema is the text of the .lcm file and of the types
/// in it): from these lookout-import makes the same log, numbered from 0. Channels with a slash in front hold Foxglove's messages in Protobuf. Files
/// of the first RUN_INFO are attachments. The same log gives the same bytes.
///
/// @return exit code
int RunMcap(const Request& request, std::ostream& errors);

}  // namespace lookout::exporter
