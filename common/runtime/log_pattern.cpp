#include "common/runtime/log_pattern.hpp"

#include <memory>
#include <spdlog/pattern_formatter.h>
#include <spdlog/spdlog.h>
#include <string_view>

#include "common/core/printable.hpp"

namespace lookout::runtime {

namespace {

class PrintableText final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& line) override {
    const auto text = PrintableLines(std::string_view(message.payload.data(), message.payload.size()));
    line.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<PrintableText>(); }
};

}  // namespace

void SetLogPattern(const std::string& pattern, bool is_utc) {
  auto formatter = std::make_unique<spdlog::pattern_formatter>(is_utc ? spdlog::pattern_time_type::utc : spdlog::pattern_time_type::local);
  formatter->add_flag<PrintableText>('v').set_pattern(pattern);
  spdlog::set_formatter(std::move(formatter));
}

}  // namespace lookout::runtime
