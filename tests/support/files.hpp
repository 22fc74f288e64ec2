// Files of tests: where the sources, recordings and programs are, whole files as text, and folders that go when the test ends.
#pragma once

#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

namespace lookout::support {

/// Folders of this checkout and of the programs of this build.
const char* SourceFolder();
const char* ProgramFolder();

inline const std::filesystem::path kSources = SourceFolder();
inline const std::filesystem::path kDemoConfig = kSources / "config/demo";
inline const std::filesystem::path kCatabotConfig = kSources / "config/catabot";
/// Recordings of others, beside the clone; a test that finds one absent skips.
inline const std::filesystem::path kRecordings = kSources / "../shared/data";

/// The program lookout-NAME of this build.
inline std::string Bin(const std::string& name) { return std::string(ProgramFolder()) + "/lookout-" + name; }

/// @return all bytes of the file
/// @throws std::runtime_error  where it cannot be read
inline std::string ReadFile(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file.string() + " cannot be read");
  std::ostringstream bytes;
  bytes << in.rdbuf();
  return bytes.str();
}

inline void WriteFile(const std::filesystem::path& file, std::string_view bytes) {
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// Writes a text of a file in place of another, which must be there.
inline void ReplaceIn(const std::filesystem::path& file, std::string_view from, std::string_view to) {
  auto text = ReadFile(file);
  const auto place = text.find(from);
  ASSERT_NE(place, std::string::npos) << file << " has no " << from;
  WriteFile(file, text.replace(place, from.size(), to));
}

/// A new, empty folder, removed with all that is in it; kept when the test failed, which then names it.
class TempDir {
 public:
  TempDir() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = test != nullptr ? test->name() : "tests";
    std::ranges::replace(name, '/', '_');
    auto place = (std::filesystem::temp_directory_path() / ("lookout_" + name.substr(0, 48) + "_XXXXXX")).string();
    if (mkdtemp(place.data()) == nullptr) throw std::runtime_error("no temporary folder " + place);
    path_ = place;
  }
  TempDir(const TempDir&) = delete;
  TempDir& operator=(const TempDir&) = delete;
  ~TempDir() {
    std::error_code error;
    if (::testing::Test::HasFailure()) {
      std::cout << "kept: " << path_.string() << "\n";
    } else {
      std::filesystem::remove_all(path_, error);
    }
  }

  const std::filesystem::path& path() const { return path_; }
  std::string string() const { return path_.string(); }
  operator const std::filesystem::path&() const { return path_; }
  std::filesystem::path operator/(const std::filesystem::path& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace lookout::support
