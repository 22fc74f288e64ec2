// NMEA 0183 for one receiver.
#pragma once

#include <optional>
#include <span>

#include "services/plotter/core/alert_sentences.hpp"
#include "services/plotter/core/notice_schedule.hpp"
#include "services/plotter/core/target_schedule.hpp"
#include "services/plotter/output.hpp"
#include "services/plotter/revision_file.hpp"

namespace lookout::plotter {

class NmeaOutput : public Output {
 public:
  /// Period of HBT and ALC, which go with ALF.
  static constexpr std::chrono::seconds kListPeriod{30};

  NmeaOutput(const OutputParams& params, std::unique_ptr<Link> link, std::chrono::microseconds target_period,
             RevisionFile revisions = RevisionFile());

 private:
  void SendOwnShip(const Told& told) override;
  void SendTargets(const Told& told) override;
  void SendNotices(const Told& told) override;
  void SendAnew() override;
  /// Ends the targets: else a receiver would still show them when the next process gives their numbers to other targets.
  void FinishTargets(const Told& told) override;
  Commands Read(const std::string& message, const Told& told) override;

  std::string Line(const Told& told, const Target& target, int number) const;
  void SendEnded(const Told& told, std::span<const Target> targets);
  void SendList(const Told& told);
  std::vector<Notice> AsTold(const Told& told) const;
  Commands Obey(const AlertCommand& command, const Told& told);
  void Refuse(const AlertCommand& command, const Told& told);

  TargetSchedule targets_;
  NoticeSchedule notices_{NoticeSchedule::Identity::kId};
  RevisionFile revisions_;
  int sequence_ = 0;            // of ALF
  int list_sequence_ = 0;       // of ALC
  int heartbeat_sequence_ = 0;  // of HBT
  std::optional<std::chrono::microseconds> list_sent_;
  bool told_well_ = true;  // by HBT
  std::optional<std::chrono::microseconds> refused_;
  std::optional<std::chrono::microseconds> own_ship_sent_;
  std::optional<std::chrono::microseconds> repeat_sent_;
};

}  // namespace lookout::plotter
