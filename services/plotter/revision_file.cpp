#include "services/plotter/revision_file.hpp"

#include <fmt/format.h>

#include <fstream>
#include <stdexcept>

#include "common/io/output_file.hpp"
#include "common/io/runtime_folder.hpp"

namespace lookout::plotter {

namespace {

constexpr std::size_t kMostNotices = 10'000;
constexpr int kMostRevision = 99;
constexpr int kMostEscalation = 9;

}  // namespace

RevisionFile RevisionFile::Of(const std::string& output_name) {
  const auto folder = io::RuntimeFolder();
  return RevisionFile(folder.empty() ? folder : folder / ("alerts_" + output_name + ".txt"));
}

std::vector<ToldNotice> RevisionFile::Read() const {
  std::vector<ToldNotice> notices;
  if (file_.empty()) return notices;
  std::ifstream in(file_);
  std::int64_t raised_us = 0;
  int cause = 0;
  int level = 0;
  int state = 0;
  int sound = 0;
  ToldNotice told;
  while (in >> told.notice.id >> cause >> raised_us >> level >> state >> sound >> told.notice.escalation >> told.revision) {
    const auto raised = UtimeFromWire(raised_us);
    const bool is_good =
        raised && told.revision >= 1 && told.revision <= kMostRevision && told.notice.escalation >= 0 && told.notice.escalation <= kMostEscalation;
    if (!is_good) return {};
    if (notices.size() == kMostNotices) return notices;  // standing notices come first in the file
    told.notice.cause = static_cast<Cause>(cause);
    told.notice.raised = *raised;
    told.notice.level = static_cast<Level>(level);
    told.notice.state = static_cast<NoticeState>(state);
    told.notice.sound = static_cast<Sound>(sound);
    notices.push_back(told);
  }
  return in.eof() ? notices : std::vector<ToldNotice>{};
}

void RevisionFile::Write(std::span<const ToldNotice> notices) {
  if (file_.empty()) return;
  std::string text;
  for (const auto& [notice, revision] : notices) {
    text += fmt::format("{} {} {} {} {} {} {} {}\n", notice.id, static_cast<int>(notice.cause), ToUtimeUs(notice.raised),
                        static_cast<int>(notice.level), static_cast<int>(notice.state), static_cast<int>(notice.sound), notice.escalation, revision);
  }
  if (text == written_) return;
  try {
    io::OutputFile out(file_, {.force = true, .inputs = {}, .tell = [](const std::string&) {}});
    out.Write(text);
    out.Commit();
    written_ = text;
  } catch (const std::runtime_error&) {
    return;  // the next process begins with 1, then
  }
}

}  // namespace lookout::plotter
