#include "services/lidar/core/vlp16/blind_sector.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace lookout::vlp16 {

namespace {

// The edges are angles of the sensor's settings, shots fall on them to a step; one more for the encoder's noise.
constexpr int kToleranceSteps = 2;

int Apart(int a_cdeg, int b_cdeg) { return std::min(ClockwiseCdeg(a_cdeg, b_cdeg), ClockwiseCdeg(b_cdeg, a_cdeg)); }

bool IsSame(const Gap& a, const Gap& b, int step_cdeg) {
  return std::max(Apart(a.from_cdeg, b.from_cdeg), Apart(a.to_cdeg, b.to_cdeg)) <= kToleranceSteps * step_cdeg;
}

}  // namespace

int BlindSector::OnPacket(const DataPacket& packet, const Steps& steps) {
  for (int i = 0; i < packet.num_steps; ++i) {
    const int azimuth_cdeg = packet.azimuth_cdeg[i];
    seen_.set(static_cast<std::size_t>(azimuth_cdeg / kBinCdeg));
    if (!sector_) continue;
    const int margin_cdeg = kToleranceSteps * steps.gap_cdeg[i];
    const int inside_cdeg = ClockwiseCdeg(sector_->from_cdeg, azimuth_cdeg);
    if (inside_cdeg > margin_cdeg && inside_cdeg < sector_->width_cdeg() - margin_cdeg) sector_.reset();
  }
  if (!steps.jump) return 0;
  sector_ = steps.jump;
  const bool was_counted = candidate_ && IsSame(candidate_->gap, *sector_, steps.gap_cdeg[0]);
  return was_counted ? std::exchange(candidate_, std::nullopt)->num_lost : 0;
}

int BlindSector::OnLoss(const Gap& gap, int num_lost, int step_cdeg) {
  if (WasSeenInside(gap, step_cdeg)) return 0;
  if (!candidate_ || !IsSame(candidate_->gap, gap, step_cdeg)) candidate_ = Candidate{gap, 0, 0};
  ++candidate_->num_sightings;
  candidate_->num_lost += num_lost;
  if (candidate_->num_sightings < kNumSightings) return 0;
  sector_ = gap;
  return std::exchange(candidate_, std::nullopt)->num_lost;
}

int BlindSector::HiddenCdeg(const Gap& gap, int step_cdeg) const {
  if (!sector_) return 0;
  const int margin_cdeg = kToleranceSteps * step_cdeg;
  const int width_cdeg = sector_->width_cdeg();
  // From a margin before the gap: both edges of the sector must come in their order before the gap ends.
  const int start_cdeg = ClockwiseCdeg(margin_cdeg, gap.from_cdeg);
  const int to_sector_cdeg = ClockwiseCdeg(start_cdeg, sector_->from_cdeg);
  const bool is_inside = to_sector_cdeg + width_cdeg <= gap.width_cdeg() + 2 * margin_cdeg;
  return is_inside ? std::min(width_cdeg, gap.width_cdeg()) : 0;
}

bool BlindSector::WasSeenInside(const Gap& gap, int step_cdeg) const {
  const int margin_cdeg = kToleranceSteps * step_cdeg + kBinCdeg;
  bool has_inside = false;
  for (int inside_cdeg = margin_cdeg; inside_cdeg < gap.width_cdeg() - margin_cdeg; inside_cdeg += kBinCdeg) {
    has_inside = true;
    if (seen_.test(static_cast<std::size_t>((gap.from_cdeg + inside_cdeg) % format::kAzimuthsPerRevolution / kBinCdeg))) return true;
  }
  return !has_inside;  // too narrow to tell
}

}  // namespace lookout::vlp16
