// The boat of a log: the config in RUN_INFO.
#pragma once

#include <optional>

#include "common/config/boat.hpp"
#include "common/core/bytes.hpp"
#include "tools/export/sink.hpp"

namespace lookout::exporter {

/// Takes a message of RUN_INFO; one without a whole boat.txtpb changes nothing.
Taken TakeRunInfo(Bytes bytes, std::optional<config::BoatFacts>& boat);

}  // namespace lookout::exporter
