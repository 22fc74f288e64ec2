// The inputs of replay: captures, text logs of NMEA 0183 and lcm-logs, told apart by their first bytes.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/runtime/progress.hpp"
#include "lookout/run_info_t.hpp"
#include "tools/log/run_marks.hpp"
#include "tools/replay/chain.hpp"
#include "tools/replay/one_publisher.hpp"
#include "tools/replay/plan.hpp"

namespace lookout::replay {

enum class InputKind { kCapture, kTextLog, kLog };

/// @return by content: a file that begins as a capture is one, a file with an event of LCM is a log, a file that navigator::IsTextLog accepts is a
/// text log, and any other is left to libpcap
/// @throws std::runtime_error when the file is no file, cannot be read, is empty, or is plainly of another kind (io::WhyNot)
InputKind KindOf(const std::filesystem::path& file);

/// The task for these files.
struct Inspection {
  Plan plan;
  bool is_logs = false;                           // else captures
  bool is_text_logs = false;                      // of the captures: nothing but text logs
  std::optional<run_info_t> recorded;             // the first RUN_INFO of the logs, if it comes before the search ends
  std::vector<std::int64_t> sizes_bytes;          // of the files
  std::optional<std::chrono::sys_days> day = {};  // of the first time in each text log in which no sentence tells a date
};

/// Reads as far as is needed to know what to run: of logs perhaps all of them.
/// @param show_share  is told how much is done, 0 to 1; may be empty
/// @throws RequestError as MakeLogPlan; std::runtime_error when captures and logs are mixed, or the logs do not hold what is needed
Inspection Inspect(const std::vector<std::filesystem::path>& files, const Request& request, const std::function<void(double)>& show_share = {});

/// Messages that were read and that were left out.
struct InputSummary {
  std::int64_t num_events = 0;                                // datagrams or messages that were handed in
  std::vector<std::pair<std::string, std::int64_t>> left;     // messages of logs that were not read, by channel: computed again, or of no use here
  std::vector<std::pair<std::string, std::int64_t>> refused;  // reason, count; counts above 0
  log::RunMarks marks;                                        // of the logs
  std::vector<log::Interleaving> interleavings;               // events are counted over all files
};

/// Feeds the files, in their order, into the chain. @throws std::runtime_error when one cannot be read; io::Stopped
InputSummary Feed(const std::vector<std::filesystem::path>& files, const Inspection& inspection, Chain& chain, runtime::Progress& progress);

/// Feeds no more: ends the chain as the input ends. The results end where the live run did, or where the log was cut.
/// @return messages of SEGMENTS that were left out, as nobody knows the live run's results of them
std::int64_t Finish(const InputSummary& summary, const Inspection& inspection, Chain& chain);

/// Config files (*.txtpb) whose text in force is not the same in both, by name.
std::vector<std::string> DifferingConfigFiles(const run_info_t& a, const run_info_t& b);

}  // namespace lookout::replay
