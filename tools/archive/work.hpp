// The work of a unit: lookout-archive work, which every engine starts.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "tools/archive/archive_folder.hpp"
#include "tools/archive/programs.hpp"
#include "tools/archive/unit.hpp"

namespace lookout::archive {

enum class UnitEnd {
  kDone,
  kFailed,      // and will fail again: a sidecar says so
  kAlready,     // the result was there
  kNotBegun,    // the recording, its truth or the programs have changed since the plan
  kNotFinished  // killed, or the computer failed: another try may succeed
};

struct UnitOutcome {
  UnitEnd end = UnitEnd::kNotFinished;
  std::string reason;
};

/// Replays, exports, evaluates, and puts the result in its place: written under a temporary name, brought to the disk, renamed, and then its sidecar.
/// Waits while another worker has the unit. @throws io::Stopped; std::runtime_error when the folder of the archive cannot be written
UnitOutcome WorkOn(const ArchiveFolder& archive, const Unit& unit, KnownPrograms& programs);

/// The units of a file, one after the other; a fault in one unit does not stop the next. @return whether each is done or failed
/// @param out  a line per unit that is neither, with the reason
bool WorkOnBatch(const ArchiveFolder& archive, const std::filesystem::path& batch, std::ostream& out);

}  // namespace lookout::archive
