#include "lab/eval/methods/lost_list.hpp"

#include "lab/eval/methods/scoring.hpp"
#include "lab/eval/table.hpp"

namespace lookout::eval {

LostList::LostList(std::ostream& out) : out_(out) {
  out_ << "method,scene,seed,scan,object,name,kind,returns,range_m,iou,outcome,segment,held_by,held_by_kind\n";
}

void LostList::Add(const std::string& method, const ScanPlace& place, const LabelledScan& truth, const std::vector<std::int32_t>& label) {
  for (const auto& lost : LostThingsOf(truth, label)) {
    const auto& about = truth.objects.at(lost.object);
    const auto holder = truth.objects.find(lost.fate.held_by);
    const bool is_held = holder != truth.objects.end();
    out_ << CsvRow({method, place.scene, std::to_string(place.seed), std::to_string(place.index), std::to_string(lost.object), about.name, about.kind,
                    std::to_string(lost.num_returns), Number(lost.range_m, 2), Number(lost.iou, 4), std::string(NameOf(lost.fate.outcome)),
                    std::to_string(lost.fate.segment), is_held ? holder->second.name : "", is_held ? holder->second.kind : ""});
  }
}

}  // namespace lookout::eval
