#include "common/io/runtime_folder.hpp"

#include <cstdlib>
#include <string_view>

namespace lookout::io {

std::filesystem::path RuntimeFolder() {
  const char* folder = std::getenv("RUNTIME_DIRECTORY");
  // systemd joins several by colons; a unit of this project has one.
  if (folder == nullptr || std::string_view(folder).find(':') != std::string_view::npos) return {};
  return folder;
}

}  // namespace lookout::io
