#include "common/io/output_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <exception>
#include <iostream>
#include <locale>
#include <optional>
#include <streambuf>
#include <system_error>
#include <utility>

#include "common/core/printable.hpp"
#include "common/io/stop_signal.hpp"

namespace lookout::io {

namespace {

namespace fs = std::filesystem;

// System calls cost more than the copy.
constexpr std::size_t kBlockBytes = 64 * 1024;
// Others may make and remove FILE.partial between the steps here; each round means that one did.
constexpr int kMaxRounds = 100;
// Results that could not be put in their place, kept beside each other.
constexpr int kMaxKept = 100;
// A program that has just made FILE.partial locks it in this time.
constexpr unsigned kLockTimeUs = 20'000;

std::runtime_error Fault(const fs::path& file, const std::string& reason) { return std::runtime_error(file.string() + ": " + reason); }

bool IsSame(const struct stat& a, const struct stat& b) { return a.st_dev == b.st_dev && a.st_ino == b.st_ino; }

// Symbolic links are not followed.
std::optional<struct stat> StateOfName(const fs::path& file) {
  struct stat state {};
  if (lstat(file.c_str(), &state) != 0) return std::nullopt;
  return state;
}

std::optional<struct stat> StateOf(const fs::path& file) {
  struct stat state {};
  if (stat(file.c_str(), &state) != 0) return std::nullopt;
  return state;
}

bool IsAmong(const std::vector<fs::path>& files, const struct stat& state) {
  for (const auto& file : files) {
    if (const auto other = StateOf(file); other && IsSame(*other, state)) return true;
  }
  return false;
}

// The open file that a name like /dev/stdout stands for, whatever it is: opened by its name a file would be written from its beginning.
std::optional<int> OpenDescriptorOf(const fs::path& file) {
  const std::string text = file.string();
  if (text == "/dev/stdout") return STDOUT_FILENO;
  if (text == "/dev/stderr") return STDERR_FILENO;
  for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"}) {
    if (!text.starts_with(folder)) continue;
    int number = -1;
    const auto* const end = text.data() + text.size();
    if (const auto result = std::from_chars(text.data() + folder.size(), end, number); result.ec == std::errc() && result.ptr == end) return number;
  }
  return std::nullopt;
}

// Whether a program says that it writes the file now: a recorder does.
bool IsLocked(const fs::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
  if (descriptor < 0) return false;
  const bool is_locked = flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  close(descriptor);
  return is_locked;
}

// @return 0, or an error number: EEXIST where `to` is there
int RenameWithoutReplacing(const fs::path& from, const fs::path& to) {
  if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  // A file system that does not know how: a second name fails where the first is taken as well.
  if (link(from.c_str(), to.c_str()) == 0) {
    unlink(from.c_str());
    return 0;
  }
  if (errno != EPERM && errno != EOPNOTSUPP && errno != ENOSYS) return errno;
  // Nor that (FAT over FUSE): what is left is to look.
  if (StateOfName(to)) return EEXIST;
  return rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

}  // namespace

struct OutputFile::Implementation final : public std::streambuf {
  Implementation(fs::path name, OutputOptions some_options) : file(std::move(name)), options(std::move(some_options)), stream(this) {
    stream.imbue(std::locale::classic());
    stream.exceptions(std::ios::badbit);  // exceptions of Write come through
    buffer.reserve(kBlockBytes);
    if (file.empty()) throw std::runtime_error("the name of the output is empty");
    if (!OpenDirectly()) OpenPartial();
  }

  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  ~Implementation() override {
    if (descriptor < 0) return;
    if (!partial.empty() && !is_done) RemovePartial();
    close(descriptor);
  }

  void Tell(const std::string& line) const {
    if (options.tell) {
      options.tell(line);
    } else {
      std::cerr << PrintableLines(line) << '\n';
    }
  }

  // @return whether the file is one that is written in place, and is open now
  bool OpenDirectly() {
    if (const auto number = OpenDescriptorOf(file)) {
      descriptor = fcntl(*number, F_DUPFD_CLOEXEC, 0);
    } else {
      const auto state = StateOf(file);  // links are followed here: to a device it may be one
      if (!state || S_ISREG(state->st_mode) || S_ISDIR(state->st_mode)) return false;
      if (S_ISBLK(state->st_mode)) throw Fault(file, "is a disk, not a file");
      do {
        ThrowIfStopAsked();
        descriptor = open(file.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);  // of a FIFO: waits until somebody reads
      } while (descriptor < 0 && errno == EINTR);
    }
    if (descriptor < 0) throw Fault(file, "cannot be written: " + ErrnoText());
    struct stat state {};
    if (fstat(descriptor, &state) != 0 || !S_ISREG(state.st_mode)) return true;
    const bool is_input = IsAmong(options.inputs, state);
    if (!is_input && OpenDescriptorOf(file)) return true;
    close(std::exchange(descriptor, -1));
    throw Fault(file, is_input ? "is an input" : "has become a regular file while it was opened");
  }

  void OpenPartial() {
    if (file.filename().empty()) throw Fault(file, "is the name of a folder");
    CheckPlace();
    partial = file;
    partial += ".partial";
    for (int i = 0; i < kMaxRounds; ++i) {
      if (TryOpenPartial()) return;
    }
    throw Fault(partial, "is made and removed by another program all the time");
  }

  void CheckPlace() const {
    const auto state = StateOfName(file);
    if (!state) {
      if (errno != ENOENT) throw Fault(file, "cannot be written: " + ErrnoText());
      return;
    }
    const auto followed = StateOf(file);
    if (S_ISDIR(state->st_mode) || (followed && S_ISDIR(followed->st_mode))) throw Fault(file, "is a folder");
    if (followed && IsAmong(options.inputs, *followed)) throw Fault(file, "is an input");
    if (options.force) {
      if (IsLocked(file)) throw Fault(file, "is being written by another program");
      return;
    }
    if (S_ISLNK(state->st_mode)) throw Fault(file, "exists already, as a symbolic link; --force replaces the link, not what it points to");
    throw Fault(file, "exists already; --force replaces it");
  }

  // @return whether it is open, new and locked; false: to be tried again
  bool TryOpenPartial() {
    const int flags = O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC | O_NOCTTY;
    const int found = open(partial.c_str(), flags);
    if (found >= 0) {
      const auto fault = RemoveLeftover(found);
      close(found);
      if (!fault.empty()) throw Fault(partial, fault);
    } else if (errno == ELOOP) {
      throw Fault(partial, "is a symbolic link: it is not followed; remove it");
    } else if (errno != ENOENT) {
      throw Fault(partial, "cannot be written: " + ErrnoText());
    }
    const int made = open(partial.c_str(), flags | O_CREAT | O_EXCL, 0666);
    if (made < 0) {
      if (errno == EEXIST) return false;
      const bool is_folder_missing = errno == ENOENT;
      throw Fault(file, is_folder_missing ? "its folder does not exist" : "cannot be made: " + ErrnoText());
    }
    // Another program may have found it between the two calls, and now looks at it (for a moment only) or has removed it.
    while (flock(made, LOCK_EX) != 0 && errno == EINTR && !IsStopAsked()) {
    }
    if (!IsNameOf(partial, made)) {
      close(made);
      return false;
    }
    try {
      CheckPlace();  // again: from here on no other program that asks for the lock puts a file there
    } catch (const std::runtime_error&) {
      unlink(partial.c_str());
      close(made);
      throw;
    }
    // The new file is open to the same people as the replaced one. Some file systems know no modes.
    const auto replaced = StateOfName(file);
    if (replaced && S_ISREG(replaced->st_mode)) static_cast<void>(fchmod(made, replaced->st_mode & 0777));
    descriptor = made;
    return true;
  }

  // FILE.partial is there: of a run that still goes on, or of one that was killed, or it is somebody's file.
  // @return why it stays; empty: it was removed, or is gone
  std::string RemoveLeftover(int found) const {
    struct stat own {};
    if (fstat(found, &own) != 0 || !S_ISREG(own.st_mode)) return "is no regular file; remove it";
    if (IsAmong(options.inputs, own)) return "is an input; give it another name";
    if (flock(found, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return "is being written by another program";
    if (!options.force) {  // made this moment, perhaps
      flock(found, LOCK_UN);
      usleep(kLockTimeUs);
      if (flock(found, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK) return "is being written by another program";
    }
    // Between open and lock the other program may have come to its end and have moved the file to its place.
    if (!IsNameOf(partial, found)) return "";
    if (!options.force) return "is there: left by a run that did not come to its end, or somebody's file; remove it, or --force does";
    if (unlink(partial.c_str()) != 0 && errno != ENOENT) return "cannot be replaced: " + ErrnoText();
    Tell(partial.string() + ": was there, and nobody was writing it; removed");
    return "";
  }

  void RemovePartial() const {
    if (!IsNameOf(partial, descriptor)) {
      Tell(file.string() + ": not written; " + partial.string() + " was taken away by somebody else");
    } else if (unlink(partial.c_str()) != 0) {
      Tell(file.string() + ": not written; " + partial.string() + " is left, incomplete: " + ErrnoText());
    } else {
      Tell(file.string() + ": not written, nothing of it is left");
    }
  }

  void Add(const char* bytes, std::size_t size) {
    if (buffer.size() + size > kBlockBytes) WriteOut();
    if (size >= kBlockBytes) {
      WriteAll(bytes, size);
    } else {
      buffer.append(bytes, size);
    }
  }

  void WriteOut() {
    WriteAll(buffer.data(), buffer.size());
    buffer.clear();
  }

  void WriteAll(const char* bytes, std::size_t size) const {
    std::size_t num_written = 0;
    while (num_written < size) {
      ThrowIfStopAsked();
      const auto result = ::write(descriptor, bytes + num_written, size - num_written);
      if (result > 0) {
        num_written += static_cast<std::size_t>(result);
      } else if (result < 0 && errno == EPIPE) {
        throw BrokenPipe(file.string() + ": nobody reads it any more");
      } else if (result < 0 && errno == EAGAIN) {
        usleep(1000);  // standard output of another program's making, that does not block
      } else if (result < 0 && errno != EINTR) {
        throw Fault(file, "write failed: " + ErrnoText());
      }
    }
  }

  int_type overflow(int_type letter) override {
    if (letter == traits_type::eof()) return 0;
    const char byte = traits_type::to_char_type(letter);
    Add(&byte, 1);
    return letter;
  }

  std::streamsize xsputn(const char* bytes, std::streamsize size) override {
    Add(bytes, static_cast<std::size_t>(size));
    return size;
  }

  void Prepare() {
    if (is_prepared) return;
    WriteOut();
    ThrowIfStopAsked();
    if (!partial.empty()) {
      // Some file systems say only now that the disk is full.
      if (fsync(descriptor) != 0 && errno != EINVAL) throw Fault(file, "not on the disk: " + ErrnoText());
      // And some (NFS) at close; a copy is closed, since the lock must last beyond the rename.
      const int copy = fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
      if (copy >= 0 && close(copy) != 0) throw Fault(file, "not on the disk: " + ErrnoText());
    }
    is_prepared = true;
  }

  void Commit() {
    Prepare();
    if (!partial.empty()) {
      MoveToPlace();
      SyncName(file);
    }
    is_done = true;
    if (close(std::exchange(descriptor, -1)) != 0 && partial.empty()) throw Fault(file, "write failed: " + ErrnoText());
  }

  void MoveToPlace() {
    if (!IsNameOf(partial, descriptor)) throw Fault(file, partial.string() + " was moved or removed while it was written");
    if (options.force && IsLocked(file)) throw Fault(file, "is being written by another program; the whole result is in " + KeepWhole().string());
    const int fault = options.force ? (rename(partial.c_str(), file.c_str()) == 0 ? 0 : errno) : RenameWithoutReplacing(partial, file);
    if (fault == 0) return;
    const std::string reason =
        fault == EEXIST ? "has appeared while it was computed" : "cannot be put in its place: " + std::system_category().message(fault);
    throw Fault(file, reason + "; the whole result is in " + KeepWhole().string());
  }

  // A whole result is not thrown away: it gets a name that no run removes. @return the name
  fs::path KeepWhole() {
    is_done = true;
    for (int i = 0; i < kMaxKept; ++i) {
      auto name = file;
      name += i == 0 ? ".whole" : ".whole." + std::to_string(i);
      const int fault = RenameWithoutReplacing(partial, name);
      if (fault == 0) SyncName(file);
      if (fault == 0) return name;
      if (fault != EEXIST) break;
    }
    return partial;
  }

  bool IsStandardOutput() const {
    struct stat own {};
    struct stat standard {};
    return partial.empty() && fstat(descriptor, &own) == 0 && fstat(STDOUT_FILENO, &standard) == 0 && IsSame(own, standard);
  }

  const fs::path file;
  const OutputOptions options;
  fs::path partial;  // empty: written in place
  int descriptor = -1;
  bool is_prepared = false;  // all is on the disk
  bool is_done = false;      // nothing is to be taken away
  std::string buffer;
  std::ostream stream;
};

OutputFile::OutputFile(const fs::path& file, OutputOptions options) : implementation_(std::make_unique<Implementation>(file, std::move(options))) {}

OutputFile::~OutputFile() = default;

void OutputFile::Write(Bytes bytes) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes as characters
  implementation_->Add(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

void OutputFile::Write(std::string_view text) { implementation_->Add(text.data(), text.size()); }

std::ostream& OutputFile::stream() { return implementation_->stream; }

void OutputFile::Flush() { implementation_->WriteOut(); }

void OutputFile::OverwriteStart(std::string_view text) {
  if (implementation_->partial.empty()) throw Fault(implementation_->file, "is written from its beginning to its end only");
  implementation_->WriteOut();
  off_t position = 0;
  while (!text.empty()) {
    const auto num_written = pwrite(implementation_->descriptor, text.data(), text.size(), position);
    if (num_written < 0 && errno == EINTR) continue;
    if (num_written <= 0) throw Fault(implementation_->file, ErrnoText());
    position += num_written;
    text.remove_prefix(static_cast<std::size_t>(num_written));
  }
}

int OutputFile::descriptor() const { return implementation_->descriptor; }

void OutputFile::Prepare() { implementation_->Prepare(); }

void OutputFile::Commit() { implementation_->Commit(); }

bool OutputFile::IsStandardOutput() const { return implementation_->IsStandardOutput(); }

const fs::path& OutputFile::file() const { return implementation_->file; }

void CommitAll(const std::vector<OutputFile*>& files) {
  for (auto* file : files) file->Prepare();
  std::exception_ptr first_fault;
  for (auto* file : files) {
    try {
      file->Commit();
    } catch (const std::runtime_error&) {
      if (!first_fault) first_fault = std::current_exception();
    }
  }
  if (first_fault) std::rethrow_exception(first_fault);
}

std::vector<fs::path> FilesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator(); entry.increment(error)) {
    if (entry->is_regular_file(error)) files.push_back(entry->path());
  }
  return files;
}

std::string ErrnoText() { return std::system_category().message(errno); }

bool IsNameOf(const fs::path& file, int descriptor) {
  struct stat own {};
  const auto named = StateOfName(file);
  return named && fstat(descriptor, &own) == 0 && IsSame(own, *named);
}

void SyncName(const fs::path& file) {
  const auto folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

}  // namespace lookout::io
