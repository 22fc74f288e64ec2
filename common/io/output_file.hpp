// A file that a program writes: it appears under its name whole or not at all, and never in the place of another one unasked.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/bytes.hpp"

namespace lookout::io {

/// Nobody reads the pipe any more that is written to.
class BrokenPipe : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct OutputOptions {
  bool force = false;                                      // --force: a file of that name is replaced, once the new one is whole
  std::vector<std::filesystem::path> inputs = {};          // of the program: none may be written over, also not with `force`
  std::function<void(const std::string& line)> tell = {};  // lines for people; empty: to standard error
};

/// The bytes go to FILE.partial beside the place of the file, locked against a second program that writes the same. Commit brings them to the disk
/// and moves them to their place. An output that is no regular file (a device, a FIFO, /dev/stdout) is written directly. An existing FILE.partial is
/// removed with `force` only.
class OutputFile {
 public:
  /// @throws std::runtime_error, with path and reason: the file exists and `force` is not set; it is a folder, or one of the inputs; its folder is
  ///         missing or cannot be written to; another program writes it now; a FILE.partial is there and `force` is not set
  explicit OutputFile(const std::filesystem::path& file, OutputOptions options = {});

  /// An uncommitted file is removed, and a line says so.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// @throws std::runtime_error when it cannot be written; BrokenPipe; Stopped when the program was asked to stop
  void Write(Bytes bytes);
  void Write(std::string_view text);

  /// Write by a stream, which throws as Write does, and formats as the "C" locale does.
  std::ostream& stream();

  /// Hands the written bytes to the kernel: a reader of FILE.partial finds them. @throws as Write
  void Flush();

  /// Writes over the first bytes of what was written: a head that is known at the end only.
  /// @throws as Write; std::runtime_error where the output is no regular file of its own
  void OverwriteStart(std::string_view text);

  /// For a library that writes by itself. Then Write and the stream may not be used.
  int descriptor() const;

  /// All is written: brings it to the disk, as FILE.partial still. After it Commit fails only where the file cannot be moved to its place.
  /// @throws as Write
  void Prepare();

  /// All is written: brings it to the disk, unless Prepare has, and moves it to its place.
  /// @throws std::runtime_error as Write; or when a file has taken the place meanwhile: then the result is kept, whole, as FILE.whole (FILE.whole.1,
  ///         ... where that is taken), and the message says so
  void Commit();

  /// Whether the bytes go where standard output goes: lines for people do not belong there then.
  bool IsStandardOutput() const;

  const std::filesystem::path& file() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Outputs that belong together: all are brought to the disk before the first gets its name. A file that cannot be moved to its place is then kept as
/// by Commit, and the others get their names all the same. @throws as Commit
void CommitAll(const std::vector<OutputFile*>& files);

/// The regular files of a folder, for OutputOptions::inputs.
std::vector<std::filesystem::path> FilesIn(const std::filesystem::path& folder);

/// The text of errno.
std::string ErrnoText();

/// Whether a name is that of an open file. Symbolic links are not followed.
bool IsNameOf(const std::filesystem::path& file, int descriptor);

/// Brings the name of a file to the disk, as fsync its bytes. Where folders cannot be synced the file system does it by itself.
void SyncName(const std::filesystem::path& file);

}  // namespace lookout::io
