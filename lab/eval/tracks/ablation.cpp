#include "lab/eval/tracks/ablation.hpp"

#include <utility>

#include "common/bus/channels.hpp"

namespace lookout::eval {

namespace {

tracker::Params With(tracker::Params params, const tracker::Without& without) {
  params.tracker.without = without;
  return params;
}

}  // namespace

std::vector<Ablation> Ablations() {
  return {{"without ledger", {.ledger = true}},     {"without watched water", {.watched_water = true}},
          {"without outlines", {.outlines = true}}, {"without beams", {.beams = true}},
          {"without surface", {.surface = true}},   {"without parts", {.parts = true}}};
}

AblatedTracker::AblatedTracker(tracker::Params params, const tracker::Without& without, std::function<void(Bytes)> on_tracks)
    : service_(bus_, With(std::move(params), without)) {
  bus_.SubscribeRaw(bus::kTracks, [on_tracks = std::move(on_tracks)](std::string_view /*channel*/, Bytes bytes) { on_tracks(bytes); });
}

void AblatedTracker::Add(std::string_view channel, Bytes bytes) {
  const auto* const known = bus::FindChannel(channel);
  if (known == nullptr || known->name == bus::kTracks.name) return;
  bus_.Publish(*known, {bytes.begin(), bytes.end()});
  HandleAll();
}

void AblatedTracker::Finish() {
  service_.Finish();
  HandleAll();
}

void AblatedTracker::HandleAll() {
  while (bus_.HandleOnce()) {
  }
}

}  // namespace lookout::eval
