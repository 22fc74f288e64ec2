#include "tools/export/boat_of_log.hpp"

#include "common/bus/decode.hpp"
#include "common/viewer/boat_of_run_info.hpp"
#include "lookout/run_info_t.hpp"

namespace lookout::exporter {

Taken TakeRunInfo(Bytes bytes, std::optional<config::BoatFacts>& boat) {
  const auto info = bus::Decode<run_info_t>(bytes);
  if (!info) return Taken::kUndecodable;
  return viewer::TakeBoat(*info, boat) ? Taken::kOk : Taken::kInconsistent;
}

}  // namespace lookout::exporter
