#include "services/page/token.hpp"

#include <fmt/format.h>
#include <sys/random.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "common/io/output_file.hpp"

namespace lookout::page {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLeastBytes = 16;
constexpr std::size_t kMostBytes = 128;

bool IsTokenLetter(char letter) {
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9') || letter == '-' || letter == '_';
}

std::string RandomToken() {
  std::array<std::uint8_t, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw std::runtime_error("the kernel gives no random numbers: " + io::ErrnoText());
  }
  std::string token;
  for (const auto byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

// Files that are made while it stands are for their owner alone.
class OwnerAlone {
 public:
  OwnerAlone() : before_(umask(S_IRWXG | S_IRWXO)) {}
  ~OwnerAlone() { umask(before_); }
  OwnerAlone(const OwnerAlone&) = delete;
  OwnerAlone& operator=(const OwnerAlone&) = delete;

 private:
  mode_t before_;
};

}  // namespace

fs::path StateFolder() {
  const auto value = [](const char* name) {
    const char* text = std::getenv(name);
    return std::string(text != nullptr ? text : "");
  };
  // systemd lists several by colons.
  const auto state = value("STATE_DIRECTORY");
  if (!state.empty()) return fs::absolute(state.substr(0, state.find(':')));
  if (const auto xdg = value("XDG_STATE_HOME"); fs::path(xdg).is_absolute()) return fs::path(xdg) / "lookout";
  if (const auto home = value("HOME"); fs::path(home).is_absolute()) return fs::path(home) / ".local/state/lookout";
  throw std::runtime_error("there is no folder for the page's state: neither STATE_DIRECTORY nor XDG_STATE_HOME nor HOME is set");
}

std::string ReadToken(const fs::path& file) {
  const auto quoted = "token file '" + file.string() + "' ";
  std::error_code error;
  const auto status = fs::status(file, error);
  if (!fs::is_regular_file(status)) throw std::runtime_error(quoted + "is no file");
  const auto for_others = fs::perms::others_all | fs::perms::group_write;
  if ((status.permissions() & for_others) != fs::perms::none) throw std::runtime_error(quoted + "is not private: chmod 640");
  std::array<char, kMostBytes + 2> text{};
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::runtime_error(quoted + "cannot be read");
  stream.read(text.data(), text.size());
  std::string token(text.data(), static_cast<std::size_t>(stream.gcount()));
  token.erase(std::ranges::find_if(token, [](char letter) { return letter == '\n' || letter == '\r'; }), token.end());
  if (token.size() < kLeastBytes || token.size() > kMostBytes || !std::ranges::all_of(token, IsTokenLetter)) {
    throw std::runtime_error(quoted + "must begin with a line of 16 to 128 of A to Z, a to z, 0 to 9, - and _; without the file a token is made");
  }
  return token;
}

std::string ReadOrMakeToken(const fs::path& file) {
  std::error_code error;
  if (fs::symlink_status(file, error).type() == fs::file_type::not_found) {
    const OwnerAlone owner_alone;
    fs::create_directories(file.parent_path());
    // FILE.partial of a process that was killed is of nobody.
    io::OutputFile output(file, {.force = true});
    output.Write(RandomToken() + "\n");
    output.Commit();
  }
  return ReadToken(file);
}

}  // namespace lookout::page
