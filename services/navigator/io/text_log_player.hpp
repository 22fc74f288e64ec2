// A file of sentences as a source, played by the times in them.
#pragma once

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include "services/navigator/io/source.hpp"

namespace lookout::navigator {

class TextLogPlayer final : public Source {
 public:
  /// A longer silence in the log, and a time that runs back, are not waited for.
  static constexpr std::chrono::seconds kMaxPause{60};

  /// @param speed  times as fast as the sentences say; 0 = as fast as it is asked
  /// @throws std::runtime_error when the file cannot be read
  TextLogPlayer(const std::string& name, const std::filesystem::path& file, double speed);

  int file_descriptor() const override { return -1; }
  void Poll(Utime) override {}
  std::optional<Piece> Receive(Utime now) override;
  bool is_finished() const override { return is_finished_; }
  std::string fault() const override { return is_finished_ ? "text log " + file_ + " is at its end" : ""; }
  std::vector<Counter> counters() override { return {{lines_name_, num_lines_}}; }

 private:
  bool ReadLine();

  std::string lines_name_;
  std::string file_;
  double speed_;
  std::ifstream in_;
  std::string line_;  // read, and not given yet
  bool has_line_ = false;
  bool is_finished_ = false;
  std::optional<Utime> due_;                            // of line_
  std::optional<std::chrono::microseconds> last_time_;  // of the day, in the sentences
  std::int64_t num_lines_ = 0;
};

}  // namespace lookout::navigator
