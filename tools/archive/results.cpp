#include "tools/archive/results.hpp"

namespace lookout::archive {

Results::Results(const ArchiveFolder& archive, Database& index)
    : archive_(archive),
      find_(index.Prepare("SELECT stamp, outcome, reason FROM result WHERE key = ?1")),
      write_(index.Prepare("INSERT OR REPLACE INTO result VALUES(?1, ?2, ?3, ?4)")),
      remove_(index.Prepare("DELETE FROM result WHERE key = ?1")) {}

Validity Results::Of(const std::string& key, bool reads_all) {
  std::optional<Validity> known;
  find_.Bind(1, key);
  if (find_.Step()) known = Validity{true, find_.Text(1) == "done", find_.Text(2), find_.Text(0)};
  find_.Reset();
  if (known && !reads_all && StampOfResult(archive_, key, known->stamp) == known->stamp) return *known;
  auto validity = Verify(archive_, key);
  if (validity.is_valid) {
    write_.Bind(1, key).Bind(2, validity.stamp).Bind(3, validity.is_done ? "done" : "failed").Bind(4, validity.reason).Run();
  } else if (known) {
    remove_.Bind(1, key).Run();
  }
  return validity;
}

}  // namespace lookout::archive
