// Seeds of fuzz_archive: a sidecar, a unit, facts of a file, a condition.
#include "tests/fuzz/corpus.hpp"
#include "tools/archive/recording.hpp"
#include "tools/archive/sidecar.hpp"
#include "tools/archive/unit.hpp"

namespace lookout::fuzz {

void WriteArchiveTexts(const Folder& folder) {
  using namespace lookout::archive;
  Unit unit;
  unit.recipe.run_digest = "aa";
  unit.recipe.run_kind = "lcm-log";
  unit.recipe.from_us = 1'781'618'400'000'000;
  unit.recipe.tables = {"tracks"};
  unit.key = KeyOf(unit.recipe);
  unit.inputs = {{"/logs/new\nline.lcmlog", 1, 2}};
  folder.Write("unit", UnitLine(unit));
  Sidecar sidecar;
  sidecar.recipe = unit.recipe;
  sidecar.is_done = true;
  sidecar.remarks = {"alerts: no ALERTS"};
  sidecar.files["tracks.csv"] = {3, "bb"};
  folder.Write("sidecar", SidecarText(sidecar));
  folder.Write("facts", FactsText({}));
  folder.Write("condition", std::string("a >= 0.5"));
  folder.Write("path", std::string("/logs/%0A\xff"));
}

}  // namespace lookout::fuzz
