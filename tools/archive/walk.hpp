// The files below folders.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tools/archive/file_stamp.hpp"

namespace lookout::archive {

struct FoundFile {
  std::filesystem::path path;  // absolute, as the folder names it
  FileStamp stamp;
};

struct Walk {
  std::vector<FoundFile> files;                                       // by path
  std::vector<std::pair<std::filesystem::path, std::string>> faults;  // folders and files that cannot be looked at, and why
};

/// Each regular file once, also where links lead to it twice or in a circle. Folders that hold a truth (truth.lcmlog, or objects.csv with
/// returns.csv) are left out: they belong to a recording beside them.
///
/// @param left_out  a folder that is not entered: the archive's own
/// @throws std::runtime_error when one of the folders is none; io::Stopped
Walk FilesBelow(const std::vector<std::filesystem::path>& folders, const std::filesystem::path& left_out);

/// The truth of a recording: a folder beside it that holds one and is called as the file with "truth" in the place of its ending
/// (rain-11.truth for rain-11.lcmlog), or "truth" where the file is the only recording of its folder. @return empty: none
std::filesystem::path TruthOf(const std::filesystem::path& file, bool is_only_one);

/// The files of a truth that lookout-eval reads, whether or not they exist.
std::vector<std::filesystem::path> FilesOfTruth(const std::filesystem::path& folder);

/// Digest over the files of a truth that exist. @param digest_of  gives the digest of the bytes of a file
std::string DigestOfTruth(const std::filesystem::path& folder, const std::function<std::string(const std::filesystem::path&)>& digest_of);

}  // namespace lookout::archive
