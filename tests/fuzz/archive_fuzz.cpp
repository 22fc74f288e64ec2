// Any text as a sidecar, a line of a list of units, facts of a file, a path and a condition: refused, or the same again behind its own text.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "tools/archive/fail_if.hpp"
#include "tools/archive/path_text.hpp"
#include "tools/archive/recording.hpp"
#include "tools/archive/sidecar.hpp"
#include "tools/archive/unit.hpp"

using namespace lookout::archive;

namespace {

template <typename Call>
void Refusing(const Call& call) {
  try {
    call();
  } catch (const std::runtime_error&) {
    return;
  } catch (const std::invalid_argument&) {
    return;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  Refusing([&text] {
    const auto sidecar = SidecarOfText(text);
    if (SidecarText(SidecarOfText(SidecarText(sidecar))) != SidecarText(sidecar)) std::abort();
  });
  Refusing([&text] {
    const auto unit = UnitOfLine(text);
    if (unit.key != KeyOf(unit.recipe) || UnitLine(UnitOfLine(UnitLine(unit))) != UnitLine(unit)) std::abort();
  });
  Refusing([&text] {
    Recording recording;
    TakeFacts(text, recording);
    FactsText(recording);
  });
  Refusing([&text] { Holds(ParseCondition(text), {{"a", 1.0}}); });
  if (text.find('\0') == std::string::npos && PathOfText(PathText(text)) != std::filesystem::path(text)) std::abort();
  PathOfText(text);
  return 0;
}
