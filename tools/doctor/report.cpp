#include <algorithm>
#include <array>
#include <sstream>

#include "common/core/printable.hpp"
#include "tools/doctor/findings.hpp"

namespace lookout::doctor {

namespace {

struct GradeStyle {
  const char* word;
  const char* colour;  // ECMA-48 SGR
};
constexpr std::array<GradeStyle, 3> kStyles{{{"ok", "\033[32m"}, {"warning", "\033[33m"}, {"fault", "\033[1;31m"}}};
constexpr const char* kColourEnd = "\033[0m";

constexpr std::size_t kGradeWidth = 9;
constexpr std::size_t kSubjectWidth = 11;
constexpr std::size_t kWordsWidth = 100;
constexpr const char* kArrow = "-> ";

// Lines of at most kWordsWidth, each but the first behind `indent`. Foreign text (a reason in HEALTH) may hold anything: only its printable
// characters are shown.
std::string Wrapped(const std::string& text, const std::string& indent) {
  std::string spaced = text;
  std::ranges::replace_if(
      spaced, [](char letter) { return static_cast<unsigned char>(letter) < ' ' || static_cast<unsigned char>(letter) == 127; }, ' ');
  std::istringstream words(PrintableLines(spaced));
  std::string wrapped;
  std::size_t width = 0;
  for (std::string word; words >> word;) {
    if (width > 0 && width + 1 + word.size() > kWordsWidth) {
      wrapped += "\n" + indent;
      width = 0;
    }
    wrapped += (width > 0 ? " " : "") + word;
    width += (width > 0 ? 1 : 0) + word.size();
  }
  return wrapped;
}

}  // namespace

std::string ToReport(const Findings& findings, bool has_colours) {
  std::string report;
  std::array<std::int64_t, kStyles.size()> counts{};
  const std::string indent(kGradeWidth + kSubjectWidth, ' ');
  for (const auto& finding : findings) {
    const auto grade = static_cast<std::size_t>(finding.grade);
    const auto& style = kStyles.at(grade);
    ++counts.at(grade);
    const auto word = fmt::format("{:<{}}", style.word, kGradeWidth);
    report += (has_colours ? style.colour + word + kColourEnd : word) + fmt::format("{:<{}}", finding.subject, kSubjectWidth) +
              Wrapped(finding.text, indent) + "\n";
    if (!finding.cure.empty()) report += indent + kArrow + Wrapped(finding.cure, indent + std::string(3, ' ')) + "\n";
  }
  const auto num_faults = counts[static_cast<std::size_t>(Grade::kFault)];
  const auto num_warnings = counts[static_cast<std::size_t>(Grade::kWarning)];
  report += num_faults == 0 && num_warnings == 0 ? "all is well\n" : Count(num_faults, "fault") + ", " + Count(num_warnings, "warning") + "\n";
  return report;
}

bool HasFault(const Findings& findings) {
  return std::ranges::any_of(findings, [](const Finding& finding) { return finding.grade == Grade::kFault; });
}

}  // namespace lookout::doctor
