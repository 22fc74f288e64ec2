#include "tests/support/files.hpp"

namespace lookout::support {

const char* SourceFolder() { return LOOKOUT_SOURCE_DIR; }
const char* ProgramFolder() { return LOOKOUT_BIN_DIR; }

}  // namespace lookout::support
