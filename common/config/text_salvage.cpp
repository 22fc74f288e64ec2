#include "common/config/text_salvage.hpp"

#include <algorithm>
#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/message.h>
#include <google/protobuf/text_format.h>
#include <map>
#include <memory>
#include <optional>

namespace lookout::config {

namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::TextFormat;
using google::protobuf::io::Tokenizer;

// Schemas nest four deep. Deeper texts are faults anyway, and must not cost time or stack.
constexpr int kMaxDepth = 32;
constexpr int kTabWidth = 8;  // of the tokenizer's columns

struct Piece {
  Tokenizer::TokenType type = Tokenizer::TYPE_END;
  std::string text;
  int line = 0;
  std::size_t begin = 0;  // bytes of the whole text
  std::size_t end = 0;
};

class FirstError final : public google::protobuf::io::ErrorCollector {
 public:
  void AddError(int line, int /*column*/, const std::string& message) override {
    if (!first_) first_ = {line, message};
  }
  const std::optional<std::pair<int, std::string>>& first() const { return first_; }

 private:
  std::optional<std::pair<int, std::string>> first_;
};

std::vector<Piece> PiecesOf(const std::string& text) {
  std::vector<std::size_t> line_begins{0};
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n') line_begins.push_back(i + 1);
  }
  google::protobuf::io::ArrayInputStream input(text.data(), static_cast<int>(text.size()));
  FirstError unused;  // the statement that the tokenizer refuses is parsed again
  Tokenizer tokenizer(&input, &unused);
  tokenizer.set_comment_style(Tokenizer::SH_COMMENT_STYLE);
  tokenizer.set_allow_f_after_float(true);
  std::vector<Piece> pieces;
  // Columns count a tab up to the next multiple of eight. A line is walked once, however many pieces it holds.
  int walked_line = -1;
  int walked_column = 0;
  std::size_t walked_byte = 0;
  const auto byte_at = [&](int line, int column) {
    if (line != walked_line || column < walked_column) {
      walked_line = line;
      walked_column = 0;
      walked_byte = line_begins.at(static_cast<std::size_t>(line));
    }
    while (walked_column < column && walked_byte < text.size()) {
      walked_column += text[walked_byte] == '\t' ? kTabWidth - walked_column % kTabWidth : 1;
      ++walked_byte;
    }
    return walked_byte;
  };
  while (tokenizer.Next()) {
    const auto& token = tokenizer.current();
    const auto begin = byte_at(token.line, token.column);
    pieces.push_back({token.type, token.text, token.line, begin, std::min(text.size(), begin + token.text.size())});
  }
  pieces.push_back({Tokenizer::TYPE_END, "", static_cast<int>(line_begins.size()) - 1, text.size(), text.size()});
  return pieces;
}

class Salvager {
 public:
  Salvager(const std::string& text, const Descriptor& schema) : text_(text), schema_(schema), pieces_(PiecesOf(text)) {
    result_.text = text;
    MatchBrackets();
  }

  SalvagedText Result() && {
    Message(&schema_, "", -1, 0);
    return std::move(result_);
  }

 private:
  struct Opening {
    std::size_t piece = 0;
    char kind = '{';
    bool is_in_other_kind = false;  // of [ and <: within the same braces the other of both is open, too
  };

  // Each bracket with the next one of its kind. One that is never closed takes no other's: braces close whatever is open within, and only what is
  // open within the same braces is closed by ] and >.
  void MatchBrackets() {
    std::vector<Opening> open;
    int num_braces = 0;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (pieces_[i].type != Tokenizer::TYPE_SYMBOL) continue;
      const char symbol = pieces_[i].text.front();
      if (symbol == '{' || symbol == '[' || symbol == '<') {
        const bool is_within = symbol != '{' && !open.empty() && open.back().kind != '{';
        open.push_back({i, symbol, is_within && (open.back().kind != symbol || open.back().is_in_other_kind)});
        num_braces += symbol == '{' ? 1 : 0;
      }
      if (symbol != '}' && symbol != ']' && symbol != '>') continue;
      const char kind = symbol == '}' ? '{' : symbol == ']' ? '[' : '<';
      const bool has_opening =
          kind == '{' ? num_braces > 0 : !open.empty() && open.back().kind != '{' && (open.back().kind == kind || open.back().is_in_other_kind);
      if (!has_opening) continue;
      while (open.back().kind != kind) open.pop_back();
      closing_of_[open.back().piece] = i;
      open.pop_back();
      num_braces -= kind == '{' ? 1 : 0;
    }
  }

  const Piece& Now() const { return pieces_[next_]; }
  const Piece& At(std::size_t index) const { return pieces_[std::min(index, pieces_.size() - 1)]; }
  bool IsEnd() const { return Now().type == Tokenizer::TYPE_END; }
  static bool IsClosing(const Piece& piece) { return piece.text == "}" || piece.text == ">"; }
  static bool IsOpening(const Piece& piece) { return piece.text == "{" || piece.text == "<"; }
  static bool IsSeparator(const Piece& piece) { return piece.text == "," || piece.text == ";"; }

  // The statements of a message, up to what closes it. Each takes the separator behind it.
  void Message(const Descriptor* descriptor, const std::string& prefix, int line_of_message, int depth) {
    const bool is_in_braces = depth > 0 && pieces_[next_ - 1].text == "{";
    std::map<const FieldDescriptor*, int> line_of_first;
    while (!IsEnd() && (depth == 0 || !IsClosing(Now()) || (is_in_braces && Now().text == ">"))) {
      if (IsSeparator(Now())) {
        ++next_;
        Refuse(next_ - 1, {At(next_ - 1).line, prefix + "text", "Expected identifier, got: " + At(next_ - 1).text}, line_of_message);
        continue;
      }
      Statement(descriptor, prefix, line_of_message, depth, line_of_first);
    }
  }

  void Statement(const Descriptor* descriptor, const std::string& prefix, int line_of_message, int depth,
                 std::map<const FieldDescriptor*, int>& line_of_first) {
    const std::size_t first = next_;
    const int line = Now().line;
    const bool has_name = Now().type == Tokenizer::TYPE_IDENTIFIER;
    const std::string name = has_name ? Now().text : "text";
    const auto* field = has_name ? descriptor->FindFieldByName(name) : nullptr;
    const std::size_t value = first + (At(first + 1).text == ":" ? 2 : 1);
    if (field != nullptr && field->message_type() != nullptr && IsOpening(At(value)) && depth + 1 < kMaxDepth) {
      next_ = value + 1;
      Message(field->message_type(), prefix + name + ".", line, depth + 1);
      if (IsEnd()) return;  // it is never closed: the parser says so
      ++next_;
      if (IsSeparator(Now())) ++next_;
      if (const auto reason = SecondReason(*field, line, line_of_first)) Refuse(first, {line, prefix + name, *reason}, line_of_message);
      return;
    }
    next_ = EndOf(first, value);
    if (IsSeparator(Now())) ++next_;
    if (const auto error = ErrorOf(*descriptor, first)) {
      Refuse(first, {line + std::min(std::max(error->first, 0), At(next_ - 1).line - line), prefix + name, error->second}, line_of_message);
    } else if (field != nullptr) {
      if (const auto reason = SecondReason(*field, line, line_of_first)) Refuse(first, {line, prefix + name, *reason}, line_of_message);
    }
  }

  // nullopt: it is the first value of the field, or one of a list.
  static std::optional<std::string> SecondReason(const FieldDescriptor& field, int line, std::map<const FieldDescriptor*, int>& line_of_first) {
    const auto [first, is_first] = line_of_first.try_emplace(&field, line);
    if (is_first || field.is_repeated()) return std::nullopt;
    return "stands twice; the first is in line " + std::to_string(first->second + 1);
  }

  // One behind the last piece of an unknown statement: a value, a list, an unknown message, or no statement at all.
  std::size_t EndOf(std::size_t first, std::size_t value) const {
    const auto& piece = At(value);
    if (const auto closing = closing_of_.find(value); closing != closing_of_.end()) return closing->second + 1;
    if (pieces_[first].type == Tokenizer::TYPE_IDENTIFIER && At(first + 1).text == ":") {
      std::size_t last = value + (piece.text == "-" ? 1 : 0);
      const auto type = At(last).type;
      if (type == Tokenizer::TYPE_STRING) {
        while (At(last + 1).type == Tokenizer::TYPE_STRING) ++last;
        return last + 1;
      }
      if (type == Tokenizer::TYPE_IDENTIFIER || type == Tokenizer::TYPE_INTEGER || type == Tokenizer::TYPE_FLOAT) {
        // `name:` without a value takes no name of the next line for one.
        if (At(last).line == pieces_[first].line || (At(last + 1).text != ":" && !IsOpening(At(last + 1)))) return last + 1;
      }
    }
    std::size_t end = first + 1;
    while (end + 1 < pieces_.size() && pieces_[end].line == pieces_[first].line && !IsClosing(pieces_[end])) ++end;
    return end;
  }

  // The parser's complaint about this statement alone. The line counts from the statement's.
  std::optional<std::pair<int, std::string>> ErrorOf(const Descriptor& descriptor, std::size_t first) const {
    const auto& begin = pieces_[first];
    const auto& last = pieces_[next_ - 1];
    const std::string alone = text_.substr(begin.begin, last.end - begin.begin) + "\n";
    const std::unique_ptr<google::protobuf::Message> scratch(google::protobuf::MessageFactory::generated_factory()->GetPrototype(&descriptor)->New());
    FirstError error;
    TextFormat::Parser parser;
    parser.RecordErrorsTo(&error);
    parser.AllowPartialMessage(true);
    google::protobuf::io::ArrayInputStream input(alone.data(), static_cast<int>(alone.size()));
    if (parser.Parse(&input, scratch.get())) return std::nullopt;
    return error.first().value_or(std::pair<int, std::string>{0, "cannot be parsed"});
  }

  void Refuse(std::size_t first, TextFault fault, int line_of_message) {
    result_.blanked.insert({fault.field, line_of_message});
    result_.faults.push_back(std::move(fault));
    for (std::size_t i = pieces_[first].begin; i < pieces_[next_ - 1].end; ++i) {
      if (result_.text[i] != '\n' && result_.text[i] != '\t') result_.text[i] = ' ';
    }
  }

  const std::string& text_;
  const Descriptor& schema_;
  std::vector<Piece> pieces_;
  std::map<std::size_t, std::size_t> closing_of_;  // of a bracket that opens, where it has one
  std::size_t next_ = 0;
  SalvagedText result_;
};

}  // namespace

SalvagedText SalvageText(const std::string& text, const Descriptor& schema) { return Salvager(text, schema).Result(); }

}  // namespace lookout::config
