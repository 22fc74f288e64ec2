#include "tools/import/unpack.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <functional>
#include <memory>

namespace lookout::importer {

namespace {

constexpr std::size_t kFirstStepBytes = std::size_t{1} << 20;

// The result of one call of a library.
struct Step {
  std::size_t num_used = 0;
  std::size_t num_made = 0;
  bool is_end = false;
  std::string fault = {};
};

using StepFunction = std::function<Step(Bytes in, std::span<std::uint8_t> out)>;

// Calls until the end of the frame, the end of the bytes, a fault, or more than `max_bytes`.
Unpacked Drive(Bytes packed, std::uint64_t max_bytes, const StepFunction& step) {
  Unpacked result;
  std::size_t num_made = 0;
  while (result.fault.empty()) {
    if (num_made == result.bytes.size()) {
      // One more byte than may come, so that too large a piece shows.
      const auto most = static_cast<std::size_t>(max_bytes) + 1;
      if (num_made == most) {
        result.fault = "more bytes than stated";
        break;
      }
      result.bytes.resize(std::min(most, std::max(kFirstStepBytes, 2 * num_made)));
    }
    const auto done = step(packed, std::span(result.bytes).subspan(num_made));
    packed = packed.subspan(done.num_used);
    num_made += done.num_made;
    result.fault = done.fault;
    if (done.is_end) break;
    const bool is_full = num_made == result.bytes.size();
    if (result.fault.empty() && !is_full && (packed.empty() || (done.num_used == 0 && done.num_made == 0))) result.fault = "cut off";
  }
  result.bytes.resize(std::min(num_made, static_cast<std::size_t>(max_bytes)));
  if (num_made > max_bytes && result.fault.empty()) result.fault = "more bytes than stated";
  return result;
}

Unpacked UnpackBzip2(Bytes packed, std::uint64_t max_bytes) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return {{}, "no memory"};
  const std::unique_ptr<bz_stream, int (*)(bz_stream*)> end(&stream, BZ2_bzDecompressEnd);
  return Drive(packed, max_bytes, [&stream](Bytes in, std::span<std::uint8_t> out) {
    // The library takes its input as char*, and does not write to it.
    stream.next_in = const_cast<char*>(reinterpret_cast<const char*>(in.data()));
    stream.avail_in = static_cast<unsigned>(in.size());
    stream.next_out = reinterpret_cast<char*>(out.data());
    stream.avail_out = static_cast<unsigned>(out.size());
    const int code = BZ2_bzDecompress(&stream);
    return Step{in.size() - stream.avail_in, out.size() - stream.avail_out, code == BZ_STREAM_END,
                code == BZ_OK || code == BZ_STREAM_END ? "" : "damaged (bzip2)"};
  });
}

Unpacked UnpackLz4(Bytes packed, std::uint64_t max_bytes) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) return {{}, "no memory"};
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> end(context, LZ4F_freeDecompressionContext);
  return Drive(packed, max_bytes, [context](Bytes in, std::span<std::uint8_t> out) {
    std::size_t num_out = out.size();
    std::size_t num_in = in.size();
    const auto code = LZ4F_decompress(context, out.data(), &num_out, in.data(), &num_in, nullptr);
    if (LZ4F_isError(code) != 0) return Step{0, 0, false, "damaged (lz4)"};
    return Step{num_in, num_out, code == 0};
  });
}

Unpacked UnpackZstdFrame(Bytes packed, std::uint64_t max_bytes) {
  const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
  if (!context) return {{}, "no memory"};
  return Drive(packed, max_bytes, [&context](Bytes in, std::span<std::uint8_t> out) {
    ZSTD_inBuffer from{in.data(), in.size(), 0};
    ZSTD_outBuffer to{out.data(), out.size(), 0};
    const auto code = ZSTD_decompressStream(context.get(), &to, &from);
    if (ZSTD_isError(code) != 0) return Step{from.pos, to.pos, false, "damaged (zstd)"};
    return Step{from.pos, to.pos, code == 0};
  });
}

Unpacked Plain(Bytes bytes, std::uint64_t max_bytes) {
  const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(bytes.size(), max_bytes));
  return {{bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count)}, bytes.size() > max_bytes ? "more bytes than stated" : ""};
}

}  // namespace

Unpacked Unpack(Packing packing, Bytes packed, std::uint64_t num_said) {
  const auto max_bytes = std::min<std::uint64_t>(num_said, kMaxPieceBytes);
  Unpacked result;
  switch (packing) {
    case Packing::kNone:
      result = Plain(packed, max_bytes);
      break;
    case Packing::kBzip2:
      result = UnpackBzip2(packed, max_bytes);
      break;
    case Packing::kLz4:
      result = UnpackLz4(packed, max_bytes);
      break;
    case Packing::kZstd:
      result = UnpackZstdFrame(packed, max_bytes);
      break;
  }
  if (num_said > kMaxPieceBytes) result.fault = "larger than " + std::to_string(kMaxPieceBytes) + " bytes";
  if (result.fault.empty() && result.bytes.size() < num_said) result.fault = "fewer bytes than stated";
  return result;
}

bool BeginsAsZstd(Bytes bytes) { return bytes.size() >= 4 && ReadU32LittleEndian(bytes, 0) == ZSTD_MAGICNUMBER; }

Unpacked UnpackZstd(Bytes packed) { return UnpackZstdFrame(packed, kMaxPieceBytes); }

}  // namespace lookout::importer
