#include "common/io/file_kind.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include "common/io/unpacked_file.hpp"

namespace lookout::io {

namespace {

using std::string_view_literals::operator""sv;

constexpr std::size_t kHeadBytes = 4096;

struct Magic {
  std::string_view bytes;
  FileKind kind;
};

// The first bytes of each format.
constexpr std::array kMagics{Magic{"\xED\xA1\xDA\x01"sv, FileKind::kLcmLog},
                             // Microseconds and nanoseconds, in both byte orders; and one with more fields, which libpcap reads, too.
                             Magic{"\xA1\xB2\xC3\xD4"sv, FileKind::kPcap}, Magic{"\xD4\xC3\xB2\xA1"sv, FileKind::kPcap},
                             Magic{"\xA1\xB2\x3C\x4D"sv, FileKind::kPcap}, Magic{"\x4D\x3C\xB2\xA1"sv, FileKind::kPcap},
                             Magic{"\xA1\xB2\xCD\x34"sv, FileKind::kPcap}, Magic{"\x34\xCD\xB2\xA1"sv, FileKind::kPcap},
                             Magic{"\x0A\x0D\x0D\x0A"sv, FileKind::kPcapng}, Magic{"\x1F\x8B\x08"sv, FileKind::kGzip},
                             Magic{"\xFD"
                                   "7zXZ\0"sv,
                                   FileKind::kXz},
                             Magic{"\x28\xB5\x2F\xFD"sv, FileKind::kZstd}, Magic{"BZh"sv, FileKind::kBzip2}, Magic{"PK\x03\x04"sv, FileKind::kZip},
                             Magic{"\x04\x22\x4D\x18"sv, FileKind::kLz4}, Magic{"#ROSBAG V"sv, FileKind::kRosBag},
                             Magic{"\x89MCAP0\r\n"sv, FileKind::kMcap}, Magic{"SQLite format 3\0"sv, FileKind::kSqlite}};

bool IsLetter(std::uint8_t byte) { return (byte >= 0x20 && byte != 0x7F) || byte == '\t' || byte == '\n' || byte == '\r'; }

// With a mark, or letters of which each second byte is zero.
bool IsUtf16(Bytes head) {
  constexpr std::size_t kLooked = 64;
  if (head.size() >= 2 && ((head[0] == 0xFF && head[1] == 0xFE) || (head[0] == 0xFE && head[1] == 0xFF))) return true;
  const std::size_t size = std::min(head.size(), kLooked) / 2 * 2;
  if (size < 8) return false;
  for (const std::size_t zero : {0U, 1U}) {
    bool is_text = true;
    for (std::size_t i = 0; i < size; ++i) is_text = is_text && (i % 2 == zero ? head[i] == 0 : IsLetter(head[i]));
    if (is_text) return true;
  }
  return false;
}

// "$GPRMC," and the like: a mark, talker and type, and a comma.
bool HoldsSentence(std::string_view text) {
  constexpr std::size_t kMinLetters = 3;
  constexpr std::size_t kMaxLetters = 10;
  for (auto mark = text.find_first_of("$!"); mark != std::string_view::npos; mark = text.find_first_of("$!", mark + 1)) {
    const auto comma = text.find(',', mark);
    if (comma == std::string_view::npos) return false;
    const auto address = text.substr(mark + 1, comma - mark - 1);
    const auto is_of_address = [](char letter) { return (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9'); };
    if (address.size() >= kMinLetters && address.size() <= kMaxLetters && std::ranges::all_of(address, is_of_address)) return true;
  }
  return false;
}

FileKind KindOfState(mode_t mode) {
  if (S_ISREG(mode)) return FileKind::kUnknown;
  if (S_ISDIR(mode)) return FileKind::kFolder;
  if (S_ISFIFO(mode)) return FileKind::kPipe;
  return S_ISSOCK(mode) ? FileKind::kSocket : FileKind::kDevice;
}

// As a shell takes it.
std::string Word(const std::filesystem::path& file) {
  auto name = file.string();
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./+,:@%";
  if (!name.empty() && name.find_first_not_of(kPlain) == std::string::npos) return name;
  std::string quoted = "'";
  for (const char letter : name) quoted += letter == '\'' ? "'\\''" : std::string(1, letter);
  return quoted + "'";
}

// The command that unpacks a compressed file.
std::string UnpackingOf(FileKind kind, const std::string& word) {
  switch (kind) {
    case FileKind::kGzip:
      return "gunzip -k " + word;
    case FileKind::kXz:
      return "xz -dk " + word;
    case FileKind::kZstd:
      return "zstd -d " + word;
    case FileKind::kBzip2:
      return "bunzip2 -k " + word;
    case FileKind::kLz4:
      return "lz4 -d " + word;
    case FileKind::kZip:
      return "unzip " + word;
    default:
      return "";
  }
}

bool IsCapture(FileKind kind) { return kind == FileKind::kPcap || kind == FileKind::kPcapng; }
bool IsText(FileKind kind) { return kind == FileKind::kNmea || kind == FileKind::kText || kind == FileKind::kUtf16; }

bool MayBe(const std::filesystem::path& file, FileKind kind, Wanted wanted) {
  switch (wanted) {
    case Wanted::kLog:
      // A log whose beginning is damaged may begin with letters.
      return kind == FileKind::kLcmLog || kind == FileKind::kUnknown || kind == FileKind::kText || kind == FileKind::kEmpty;
    case Wanted::kCapture:
      return IsCapture(kind) || kind == FileKind::kUnknown || (kind == FileKind::kGzip && IsCapture(PackedKindOf(file)));
    case Wanted::kTextLog:
      return IsText(kind) || kind == FileKind::kUnknown || kind == FileKind::kGzip;
    case Wanted::kImport:
      return kind == FileKind::kText || kind == FileKind::kUnknown || kind == FileKind::kRosBag || kind == FileKind::kMcap ||
             kind == FileKind::kSqlite;
    case Wanted::kRecording:
      return kind == FileKind::kLcmLog || kind == FileKind::kUnknown || IsCapture(kind) || IsText(kind) || kind == FileKind::kGzip;
  }
  return false;
}

std::string_view NotOf(Wanted wanted) {
  if (wanted == Wanted::kLog) return ", no lcm-log";
  if (wanted == Wanted::kTextLog) return ", no text log of NMEA 0183";
  if (wanted == Wanted::kImport) return ", no recording of others that is known here (ROS bag, rosbag2, MCAP, detections of Autoferry)";
  return wanted == Wanted::kCapture ? ", no capture (pcap, pcapng)" : ", no capture, text log or lcm-log";
}

// The command that helps; empty where none is known.
std::string HelpOf(const std::filesystem::path& file, FileKind kind, Wanted wanted) {
  const auto word = Word(file);
  const auto replay = "lookout-replay --config DIR --in " + word + " --out NEW.lcmlog";
  switch (kind) {
    case FileKind::kFolder:
      return "give its files: " + word + "/*";
    case FileKind::kPipe:
    case FileKind::kSocket:
    case FileKind::kDevice:
      return "it is read more than once, so store it as a file first: cat " + word + " > NEW";
    case FileKind::kPcap:
    case FileKind::kPcapng:
      return "a log is made of it by: " + replay;
    case FileKind::kUtf16:
      if (wanted == Wanted::kCapture) return "make it UTF-8 first: iconv -f UTF-16 -t UTF-8 " + word + " > NEW";
      return "a log is made of its sentences by: " + replay;
    case FileKind::kNmea:
    case FileKind::kText:
      if (wanted == Wanted::kCapture) return "lookout-replay reads it as a text log if a sentence with a right checksum stands in its first MB";
      return (kind == FileKind::kText ? "if it holds sentences of NMEA 0183, a log is made of them by: " : "a log is made of its sentences by: ") +
             replay;
    case FileKind::kLcmLog:
      return "it is computed again by: " + replay;
    case FileKind::kGzip:
      if (IsCapture(PackedKindOf(file)) && wanted == Wanted::kLog)
        return "it holds " + std::string(InWords(PackedKindOf(file))) + ", and a log is made of it by: " + replay;
      [[fallthrough]];
    case FileKind::kXz:
    case FileKind::kZstd:
    case FileKind::kBzip2:
    case FileKind::kLz4:
    case FileKind::kZip:
      return "unpack it first: " + UnpackingOf(kind, word);
    case FileKind::kRosBag:
    case FileKind::kMcap:
      return "a log is made of it by: lookout-import --config DIR --in " + word + " --out NEW.lcmlog";
    case FileKind::kSqlite:
      return "of a ROS 2 bag a log is made by: lookout-import --config DIR --in " + word +
             " --out NEW.lcmlog; a chart (MBTiles) goes to lookout-page --map";
    default:
      return "";
  }
}

std::string Reason(const std::filesystem::path& file, FileKind kind, Wanted wanted) {
  const auto help = HelpOf(file, kind, wanted);
  return file.string() + ": is " + std::string(InWords(kind)) + std::string(NotOf(wanted)) + (help.empty() ? "" : "; " + help);
}

}  // namespace

FileKind FileKindOfHead(Bytes head) {
  if (head.empty()) return FileKind::kEmpty;
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  for (const auto& magic : kMagics) {
    if (text.starts_with(magic.bytes)) return magic.kind;
  }
  if (IsUtf16(head)) return FileKind::kUtf16;
  if (!std::ranges::all_of(head, IsLetter)) return FileKind::kUnknown;
  return HoldsSentence(text) ? FileKind::kNmea : FileKind::kText;
}

FileKind FileKindOf(const std::filesystem::path& file) {
  struct stat state {};
  if (stat(file.c_str(), &state) != 0) return errno == ENOENT || errno == ENOTDIR ? FileKind::kMissing : FileKind::kUnreadable;
  if (const auto kind = KindOfState(state.st_mode); kind != FileKind::kUnknown) return kind;
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return FileKind::kUnreadable;
  std::array<std::uint8_t, kHeadBytes> head{};
  ssize_t size = 0;
  do {
    size = pread(descriptor, head.data(), head.size(), 0);
  } while (size < 0 && errno == EINTR);
  close(descriptor);
  return size < 0 ? FileKind::kUnreadable : FileKindOfHead(Bytes(head).first(static_cast<std::size_t>(size)));
}

FileKind PackedKindOf(const std::filesystem::path& file) try {
  UnpackedFile packed(file);
  std::array<std::uint8_t, kHeadBytes> head{};
  const auto size = packed.Read(head);
  return size == 0 && !packed.fault().empty() ? FileKind::kUnknown : FileKindOfHead(Bytes(head).first(size));
} catch (const std::runtime_error&) {
  return FileKind::kUnknown;
}

std::string_view InWords(FileKind kind) {
  switch (kind) {
    case FileKind::kMissing:
      return "no such file";
    case FileKind::kUnreadable:
      return "a file that cannot be read";
    case FileKind::kFolder:
      return "a folder";
    case FileKind::kPipe:
      return "a pipe";
    case FileKind::kSocket:
      return "a socket";
    case FileKind::kDevice:
      return "a device";
    case FileKind::kEmpty:
      return "empty";
    case FileKind::kPcap:
      return "a capture (pcap)";
    case FileKind::kPcapng:
      return "a capture (pcapng)";
    case FileKind::kLcmLog:
      return "an lcm-log";
    case FileKind::kGzip:
      return "compressed by gzip";
    case FileKind::kXz:
      return "compressed by xz";
    case FileKind::kZstd:
      return "compressed by zstd";
    case FileKind::kBzip2:
      return "compressed by bzip2";
    case FileKind::kZip:
      return "an archive of zip";
    case FileKind::kLz4:
      return "compressed by lz4";
    case FileKind::kRosBag:
      return "a ROS bag";
    case FileKind::kMcap:
      return "a recording in MCAP (ROS 2 bag)";
    case FileKind::kSqlite:
      return "an SQLite database (ROS 2 bag, or a chart in MBTiles)";
    case FileKind::kUtf16:
      return "text in UTF-16";
    case FileKind::kNmea:
      return "a text log of NMEA 0183";
    case FileKind::kText:
      return "text";
    case FileKind::kUnknown:
      return "a file of unknown kind";
  }
  return "";
}

std::string WhyNot(const std::filesystem::path& file, Wanted wanted) {
  const auto kind = FileKindOf(file);
  if (MayBe(file, kind, wanted)) return "";
  const auto name = file.string() + ": ";
  if (kind == FileKind::kMissing) return name + "no such file";
  if (kind == FileKind::kUnreadable) return name + "cannot be read: the right to read it is missing, or the disk fails";
  if (kind == FileKind::kEmpty) return name + "is empty";
  return Reason(file, kind, wanted);
}

std::string NoEventText(const std::filesystem::path& file) {
  const auto kind = FileKindOf(file);
  if (kind == FileKind::kEmpty) return file.string() + ": is empty";
  if (kind == FileKind::kText) return Reason(file, kind, Wanted::kLog);
  const auto reason = WhyNot(file, Wanted::kLog);
  return reason.empty() ? file.string() + ": is no lcm-log: it holds no event" : reason;
}

}  // namespace lookout::io
