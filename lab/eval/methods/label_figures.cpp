#include "lab/eval/methods/label_figures.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "lab/eval/methods/label_entropy.hpp"
#include "lab/eval/methods/outcome.hpp"
#include "lab/eval/methods/results.hpp"

namespace lookout::eval {
namespace {

constexpr std::array kAllLabelFigures{&LabelFigures::iou,
                                      &LabelFigures::land_iou,
                                      &LabelFigures::land_too_many,
                                      &LabelFigures::lost,
                                      &LabelFigures::over_entropy,
                                      &LabelFigures::under_entropy,
                                      &LabelFigures::panoptic_quality,
                                      &LabelFigures::segmentation_quality,
                                      &LabelFigures::recognition_quality};

std::int64_t NumLabelsOfLand(const Confusion::Matches& matches, const std::set<int>& land) {
  return std::ranges::count_if(matches.segments, [&land](const auto& entry) {
    std::int64_t num_of_land = 0;
    for (const auto& [object, count] : entry.second.returns_by_object) num_of_land += land.contains(object) ? count : 0;
    return 2 * num_of_land > entry.second.num_returns;
  });
}

}  // namespace

void LabelFigures::Add(const LabelFigures& other) {
  for (const auto figure : kAllLabelFigures) (this->*figure).Add(other.*figure);
}

void LabelFigures::AddValues(const LabelFigures& scene) {
  for (const auto figure : kAllLabelFigures) {
    if ((scene.*figure).count > 0) (this->*figure).Add((scene.*figure).value());
  }
}

LabelFigures LabelFiguresOf(const Confusion::Matches& matches, const std::set<int>& land) {
  LabelFigures figures;
  Mean iou;
  Mean land_iou;
  for (const auto& [id, object] : matches.objects) {
    iou.Add(object.iou);
    if (land.contains(id)) {
      land_iou.Add(object.iou);
    } else if (object.num_returns >= Score::kMinReturnsOfThing) {
      figures.lost.Add(object.iou < kFoundIou ? 1.0 : 0.0);
    }
  }
  if (iou.count > 0) figures.iou.Add(iou.value());
  if (land_iou.count > 0) {
    figures.land_iou.Add(land_iou.value());
    figures.land_too_many.Add(static_cast<double>(std::max<std::int64_t>(NumLabelsOfLand(matches, land) - land_iou.count, 0)));
  }
  const auto entropy = EntropyOf(matches);
  figures.over_entropy = entropy.over;
  figures.under_entropy = entropy.under;
  const auto panoptic = PanopticQualityOf(matches);
  figures.panoptic_quality = panoptic.quality;
  figures.segmentation_quality = panoptic.segmentation;
  figures.recognition_quality = panoptic.recognition;
  return figures;
}

}  // namespace lookout::eval
