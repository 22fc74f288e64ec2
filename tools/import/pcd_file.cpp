#include "tools/import/pcd_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <map>
#include <optional>
#include <utility>

#include "common/core/bytes.hpp"
#include "tools/import/file_bytes.hpp"

namespace lookout::importer {

namespace {

static_assert(std::endian::native == std::endian::little, "binary PCD files are little-endian");

// More than any writer makes, and small enough that sums cannot overflow.
constexpr std::size_t kMaxFields = 64;
constexpr std::size_t kMaxCount = 1024;

using Words = std::vector<std::string_view>;

struct HeaderLine {
  int number = 0;
  Words values;
};

// The lines of the header by their first words.
class Lines {
 public:
  explicit Lines(const std::string& name) : name_(name) {}

  void Add(int number, const Words& words) {
    const auto [at, is_new] = lines_.try_emplace(std::string(words.front()));
    if (!is_new) RefuseLine(name_, number, at->first + " stands in line " + std::to_string(at->second.number) + " already");
    at->second = {number, Words(words.begin() + 1, words.end())};
    last_ = number;
  }

  const HeaderLine* Find(const std::string& key) const {
    const auto found = lines_.find(key);
    return found == lines_.end() ? nullptr : &found->second;
  }
  const HeaderLine& At(const std::string& key) const {
    const auto* line = Find(key);
    if (line == nullptr) RefuseLine(name_, last_, "the header has no " + key);
    return *line;
  }
  // @return the whole numbers of a line with as many values as there are fields, or of one value
  std::vector<std::size_t> Numbers(const HeaderLine& line, std::size_t expected, std::size_t max_value) const {
    if (line.values.size() != expected) {
      RefuseLine(name_, line.number, std::to_string(line.values.size()) + " values where " + std::to_string(expected) + " belong");
    }
    std::vector<std::size_t> numbers;
    for (const auto word : line.values) {
      std::size_t number = 0;
      const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), number);
      if (fault != std::errc() || end != word.data() + word.size() || number > max_value) {
        RefuseLine(name_, line.number, "no whole number from 0 to " + std::to_string(max_value) + ": " + std::string(word.substr(0, 32)));
      }
      numbers.push_back(number);
    }
    return numbers;
  }

 private:
  const std::string& name_;
  std::map<std::string, HeaderLine, std::less<>> lines_;
  int last_ = 1;
};

std::optional<PcdField::Type> ToType(std::string_view word) {
  if (word == "F") return PcdField::Type::kFloat;
  if (word == "I") return PcdField::Type::kSigned;
  if (word == "U") return PcdField::Type::kUnsigned;
  return std::nullopt;
}

void AddFields(const Lines& lines, const std::string& name, PcdHeader& header) {
  const auto& names = lines.At("FIELDS");
  const std::size_t num_fields = names.values.size();
  if (num_fields == 0 || num_fields > kMaxFields) RefuseLine(name, names.number, "from 1 to " + std::to_string(kMaxFields) + " fields");
  const auto& size_line = lines.At("SIZE");
  const auto sizes = lines.Numbers(size_line, num_fields, 8);
  const auto& types = lines.At("TYPE");
  if (types.values.size() != num_fields) RefuseLine(name, types.number, "as many types as fields belong here");
  const auto* count_line = lines.Find("COUNT");
  const auto counts = count_line != nullptr ? lines.Numbers(*count_line, num_fields, kMaxCount) : std::vector<std::size_t>(num_fields, 1);
  for (std::size_t i = 0; i < num_fields; ++i) {
    const auto type = ToType(types.values[i]);
    if (!type) RefuseLine(name, types.number, "a type is F, I or U, not " + std::string(types.values[i].substr(0, 32)));
    const bool is_float = *type == PcdField::Type::kFloat;
    if (sizes[i] != 4 && sizes[i] != 8 && (is_float || (sizes[i] != 1 && sizes[i] != 2))) {
      RefuseLine(name, size_line.number,
                 "there is no number of type " + std::string(types.values[i]) + " with " + std::to_string(sizes[i]) + " bytes");
    }
    header.fields.push_back({std::string(names.values[i]), *type, sizes[i], counts[i], header.point_bytes, header.point_columns});
    header.point_bytes += sizes[i] * counts[i];
    header.point_columns += counts[i];
  }
  if (header.point_bytes == 0) RefuseLine(name, names.number, "a point holds nothing");
}

void CheckViewpoint(const Lines& lines, const std::string& name) {
  const auto* line = lines.Find("VIEWPOINT");
  if (line == nullptr) return;
  static const std::vector<double> kOrigin{0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0};  // place, and a quaternion with its scalar first
  std::vector<double> values;
  for (const auto word : line->values) {
    double value = 0.0;
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (fault != std::errc() || end != word.data() + word.size()) RefuseLine(name, line->number, "not a number: " + std::string(word.substr(0, 32)));
    values.push_back(value);
  }
  if (values != kOrigin) {
    RefuseLine(name, line->number, "the sensor must be at the origin and upright (0 0 0 1 0 0 0): bring the points into its frame");
  }
}

// Takes the next line off, without its end. @return false at the end
bool NextLine(std::string_view& rest, std::string_view& line) {
  if (rest.empty()) return false;
  const auto end = rest.find('\n');
  line = rest.substr(0, end);
  rest = end == std::string_view::npos ? std::string_view{} : rest.substr(end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return true;
}

// Words between blanks and tabs, into `words`, which is cleared first.
void SplitWords(std::string_view line, Words& words) {
  constexpr std::string_view kBlanks = " \t";
  words.clear();
  for (auto begin = line.find_first_not_of(kBlanks); begin != std::string_view::npos;) {
    const auto end = std::min(line.find_first_of(kBlanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlanks, end);
  }
}

struct FormRow {
  std::string_view word;
  PcdForm form;
};
constexpr std::array kForms{FormRow{"ascii", PcdForm::kText}, FormRow{"binary", PcdForm::kBinary},
                            FormRow{"binary_compressed", PcdForm::kCompressed}};

PcdHeader ParsePcdHeader(std::string_view bytes, const std::string& name, PcdReader::Cut cut) {
  static const std::vector<std::string_view> kKeys{"VERSION", "FIELDS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};
  PcdHeader header;
  Lines lines(name);
  std::string_view rest = bytes;
  std::string_view line;
  Words words;
  int number = 0;
  while (lines.Find("DATA") == nullptr) {
    ++number;
    if (!NextLine(rest, line)) RefuseLine(name, number, "the file ends before the line DATA");
    SplitWords(line, words);
    if (words.empty() || words.front().front() == '#') continue;
    if (std::ranges::find(kKeys, words.front()) == kKeys.end()) {
      RefuseLine(name, number, "no line of a PCD header: " + std::string(words.front().substr(0, 32)));
    }
    lines.Add(number, words);
  }
  header.data_offset = bytes.size() - rest.size();
  header.data_line = number + 1;

  AddFields(lines, name, header);
  CheckViewpoint(lines, name);
  const auto size_of = [&](const std::string& key) { return lines.Numbers(lines.At(key), 1, kMaxPcdPoints).front(); };
  header.width = size_of("WIDTH");
  header.height = size_of("HEIGHT");
  header.num_points = header.width * header.height;
  if (const auto* points = lines.Find("POINTS"); points != nullptr && size_of("POINTS") != header.num_points) {
    RefuseLine(name, points->number, "POINTS is not WIDTH times HEIGHT, " + std::to_string(header.num_points));
  }
  if (header.num_points > kMaxPcdPoints) {
    RefuseLine(name, lines.At("WIDTH").number, std::to_string(header.num_points) + " points are no scan");
  }
  const auto& data = lines.At("DATA");
  const auto* const form = data.values.size() == 1 ? std::ranges::find(kForms, data.values[0], &FormRow::word) : kForms.end();
  if (form == kForms.end()) RefuseLine(name, data.number, "DATA is ascii, binary or binary_compressed");
  header.form = form->form;
  if (cut == PcdReader::Cut::kRead || header.form == PcdForm::kCompressed) return header;
  const bool is_binary = header.form == PcdForm::kBinary;
  // A number of the text form takes a character and a blank or the end of its line, but for the last one of the file.
  const std::size_t num_needed = header.num_points * (is_binary ? header.point_bytes : 2 * header.point_columns);
  const std::size_t num_there = rest.size() + (is_binary ? 0 : 1);
  if (num_needed > num_there || (is_binary && num_needed != num_there)) {
    RefuseLine(name, data.number,
               std::to_string(header.num_points) + " points take " + (is_binary ? "" : "at least ") + std::to_string(num_needed) + " bytes; " +
                   std::to_string(rest.size()) + " follow");
  }
  return header;
}

template <typename T>
double NumberAt(const char* bytes) {
  T value{};
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<double>(value);
}

double BinaryNumber(const PcdField& field, const char* bytes) {
  switch (field.type) {
    case PcdField::Type::kFloat:
      return field.size_bytes == 4 ? NumberAt<float>(bytes) : NumberAt<double>(bytes);
    case PcdField::Type::kSigned:
      return field.size_bytes == 1   ? NumberAt<std::int8_t>(bytes)
             : field.size_bytes == 2 ? NumberAt<std::int16_t>(bytes)
             : field.size_bytes == 4 ? NumberAt<std::int32_t>(bytes)
                                     : NumberAt<std::int64_t>(bytes);
    case PcdField::Type::kUnsigned:
      return field.size_bytes == 1   ? NumberAt<std::uint8_t>(bytes)
             : field.size_bytes == 2 ? NumberAt<std::uint16_t>(bytes)
             : field.size_bytes == 4 ? NumberAt<std::uint32_t>(bytes)
                                     : NumberAt<std::uint64_t>(bytes);
  }
  return 0.0;
}

}  // namespace

bool UnpackLzf(std::string_view packed, std::size_t size, std::string& unpacked) {
  constexpr std::size_t kLongestMatch = 264;  // of three bytes
  constexpr std::size_t kLiteralEnd = 32;     // a control byte n below this: n + 1 literals follow
  unpacked.clear();
  if (size > kLongestMatch * packed.size()) return false;
  unpacked.reserve(size);
  std::size_t at = 0;
  const auto has = [&](std::size_t count) { return count <= packed.size() - at; };
  const auto byte = [&] { return static_cast<std::size_t>(static_cast<unsigned char>(packed[at++])); };
  while (has(1)) {
    const auto control = byte();
    if (control < kLiteralEnd) {
      if (!has(control + 1) || control + 1 > size - unpacked.size()) return false;
      unpacked.append(packed.substr(at, control + 1));
      at += control + 1;
      continue;
    }
    auto length = control >> 5;
    if (!has(length == 7 ? 2 : 1)) return false;
    if (length == 7) length += byte();
    const auto distance = ((control & 0x1F) << 8) + byte() + 1;
    length += 2;
    if (distance > unpacked.size() || length > size - unpacked.size()) return false;
    // It may reach into what it makes.
    for (auto from = unpacked.size() - distance; length > 0; --length, ++from) unpacked.push_back(unpacked[from]);
  }
  return unpacked.size() == size;
}

PcdReader::PcdReader(std::string_view bytes, std::string name, Cut cut)
    : bytes_(bytes), name_(std::move(name)), header_(ParsePcdHeader(bytes, name_, cut)) {
  rest_ = bytes_.substr(header_.data_offset);
  line_ = header_.data_line - 1;
  if (header_.form != PcdForm::kCompressed) return;
  constexpr std::size_t kSizesBytes = 8;  // packed and unpacked
  const Bytes data(reinterpret_cast<const std::uint8_t*>(rest_.data()), rest_.size());
  const auto size = header_.num_points * header_.point_bytes;
  if (size == 0) return;
  if (data.size() < kSizesBytes) RefuseByte(name_, header_.data_offset, "the file ends before its points");
  const std::size_t packed_size = ReadU32LittleEndian(data, 0);
  if (ReadU32LittleEndian(data, 4) != size || size > kMaxPointFileBytes) {
    RefuseByte(
        name_, header_.data_offset + 4,
        std::to_string(header_.num_points) + " points take " + std::to_string(size) + " bytes, not " + std::to_string(ReadU32LittleEndian(data, 4)));
  }
  if (packed_size > rest_.size() - kSizesBytes) RefuseByte(name_, header_.data_offset, "the file ends inside its compressed points");
  if (!UnpackLzf(rest_.substr(kSizesBytes, packed_size), size, unpacked_)) RefuseByte(name_, header_.data_offset, "the points do not unpack");
}

const PcdField* PcdReader::Find(std::string_view field_name) const {
  const auto is_named = [field_name](const PcdField& field) { return field.name == field_name; };
  const auto found = std::ranges::find_if(header_.fields, is_named);
  if (found == header_.fields.end()) return nullptr;
  if (found->count != 1 || std::ranges::count_if(header_.fields, is_named) != 1) {
    throw PointFileError(name_ + ": the field " + std::string(field_name) + " must be one number, and stand once");
  }
  return &*found;
}

bool PcdReader::Next() {
  if (header_.form == PcdForm::kText) return NextTextPoint();
  if (num_read_ >= header_.num_points) return false;
  ++num_read_;
  if (header_.form == PcdForm::kBinary && num_read_ * header_.point_bytes > rest_.size()) {
    --num_read_;
    RefuseByte(name_, bytes_.size(), "the file ends inside point " + std::to_string(num_read_ + 1) + " of " + std::to_string(header_.num_points));
  }
  return true;
}

bool PcdReader::NextTextPoint() {
  std::string_view line;
  do {
    if (!NextLine(rest_, line)) {
      if (num_read_ == header_.num_points) return false;
      throw PointFileError(name_ + ": " + std::to_string(num_read_) + " points, where the header says " + std::to_string(header_.num_points));
    }
    ++line_;
    SplitWords(line, words_);
  } while (words_.empty());
  if (words_.size() != header_.point_columns) {
    RefuseLine(name_, line_, std::to_string(words_.size()) + " numbers where " + std::to_string(header_.point_columns) + " belong");
  }
  if (num_read_ >= header_.num_points) RefuseLine(name_, line_, "more points than the header says, " + std::to_string(header_.num_points));
  ++num_read_;
  return true;
}

double PcdReader::Number(const PcdField& field) const {
  const auto index = num_read_ - 1;
  switch (header_.form) {
    case PcdForm::kBinary:
      return BinaryNumber(field, rest_.data() + index * header_.point_bytes + field.offset_bytes);
    case PcdForm::kCompressed:
      return BinaryNumber(field, unpacked_.data() + header_.num_points * field.offset_bytes + index * field.size_bytes * field.count);
    case PcdForm::kText:
      break;
  }
  const auto word = words_[field.offset_columns];
  double value = 0.0;
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (fault != std::errc() || end != word.data() + word.size()) RefuseLine(name_, line_, "not a number: " + std::string(word.substr(0, 32)));
  return value;
}

void PcdReader::Refuse(const std::string& reason) const {
  if (header_.form == PcdForm::kText) RefuseLine(name_, line_, reason);
  if (header_.form == PcdForm::kBinary) RefuseByte(name_, header_.data_offset + (num_read_ - 1) * header_.point_bytes, reason);
  throw PointFileError(name_ + ": point " + std::to_string(num_read_) + ": " + reason);
}

}  // namespace lookout::importer
