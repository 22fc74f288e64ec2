#include "lab/eval/lost_list.hpp"

#include <fmt/format.h>

#include "common/core/printable.hpp"
#include "lab/eval/scoring.hpp"

namespace lookout::eval {

LostList::LostList(std::ostream& out) : out_(out) {
  out_ << "method,scene,seed,scan,object,name,kind,returns,range_m,iou,outcome,segment,held_by,held_by_kind\n";
}

void LostList::Add(const std::string& method, const ScanPlace& place, const LabelledScan& truth, const std::vector<std::int32_t>& label) {
  for (const auto& lost : LostThingsOf(truth, label)) {
    const auto& about = truth.objects.at(lost.object);
    const auto holder = truth.objects.find(lost.fate.held_by);
    const bool is_held = holder != truth.objects.end();
    out_ << fmt::format("{},{},{},{},{},{},{},{},{:.2f},{:.4f},{},{},{},{}\n", CsvText(method), CsvText(place.scene), place.seed, place.index,
                        lost.object, CsvText(about.name), CsvText(about.kind), lost.num_returns, lost.range_m, lost.iou, NameOf(lost.fate.outcome),
                        lost.fate.segment, is_held ? CsvText(holder->second.name) : "", is_held ? CsvText(holder->second.kind) : "");
  }
}

}  // namespace lookout::eval
