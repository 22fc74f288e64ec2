#include <fmt/format.h>

#include <ostream>

#include "tools/log/commands.hpp"
#include "tools/log/event_reader.hpp"
#include "tools/log/log_output.hpp"
#include "tools/log/time_text.hpp"

namespace lookout::log {

void Repair(const std::filesystem::path& input, const std::filesystem::path& output_file, bool force, std::ostream& out, std::ostream& errors) {
  EventReader reader(input);
  LogOutput output(output_file, {.force = force, .inputs = {input}});
  auto& lines = output.IsStandardOutput() ? errors : out;  // a log that goes there is not mixed with lines
  std::optional<Utime> last;
  std::size_t num_named = 0;
  const auto name_damage = [&](const std::string& next) {
    for (; num_named < reader.damage().size(); ++num_named) {
      const auto& stretch = reader.damage()[num_named];
      lines << fmt::format("lost: {} bytes at byte {}, between {} and {}\n", stretch.size_bytes, stretch.offset_bytes,
                           last ? TimeText(*last) : "the start", next);
    }
  };
  while (const auto event = reader.Next()) {
    name_damage(TimeText(event->time));
    output.Write(*event);
    last = event->time;
  }
  name_damage("the end");
  if (reader.num_events() == 0) throw std::runtime_error(input.string() + ": is no lcm-log: it holds no event");
  output.Commit();
  lines << fmt::format("{}: {} events of {} kept, {} bytes lost in {} stretches\n", output_file.string(), output.num_events(), input.string(),
                       reader.num_damaged_bytes(), reader.damage().size());
}

}  // namespace lookout::log
