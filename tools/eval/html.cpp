#include "tools/eval/html.hpp"

#include <algorithm>

namespace lookout::eval {
namespace {

bool IsNumber(const std::string& cell) { return cell.find_first_not_of("0123456789+-.% /\n") == std::string::npos; }

std::string Attribute(std::string_view name, std::string_view value) {
  return value.empty() ? "" : " " + std::string(name) + "=\"" + Escape(value) + "\"";
}

}  // namespace

std::string Escape(std::string_view text) {
  std::string markup;
  markup.reserve(text.size());
  for (const char letter : text) {
    switch (letter) {
      case '&':
        markup += "&amp;";
        break;
      case '<':
        markup += "&lt;";
        break;
      case '>':
        markup += "&gt;";
        break;
      case '"':
        markup += "&quot;";
        break;
      case '\'':
        markup += "&#39;";
        break;
      case '\n':
      case '\t':
        markup += letter;
        break;
      default: {
        constexpr unsigned char kFirstPrintable = 0x20;
        constexpr unsigned char kDelete = 0x7F;
        const auto code = static_cast<unsigned char>(letter);
        if (code < kFirstPrintable || code == kDelete) {
          markup += "&#xFFFD;";
        } else {
          markup += letter;
        }
      }
    }
  }
  return markup;
}

std::string Element(std::string_view name, std::string_view text) {
  return "<" + std::string(name) + ">" + Escape(text) + "</" + std::string(name) + ">\n";
}

std::string HtmlTable::Markup() const {
  const auto has_words = [this](std::size_t column) {
    return std::ranges::any_of(rows_, [column](const std::vector<HtmlCell>& row) { return !IsNumber(row[column].text); });
  };
  std::vector<std::string> classes;  // of each column
  for (std::size_t column = 0; column < headings_.size(); ++column) classes.emplace_back(has_words(column) ? "words" : "");

  std::string markup = "<div class=\"wide\"><table>\n<caption>" + Escape(caption_) + "</caption>\n<thead><tr>";
  for (std::size_t column = 0; column < headings_.size(); ++column) {
    const auto& heading = headings_[column];
    markup += "<th scope=\"col\"" + Attribute("class", heading.is_upright ? "upright" : classes[column]) + "><span>" + Escape(heading.text) +
              "</span></th>";
  }
  markup += "</tr></thead>\n<tbody>\n";
  for (const auto& row : rows_) {
    markup += "<tr>";
    for (std::size_t column = 0; column < row.size(); ++column) {
      const auto& cell = row[column];
      if (column == 0) {
        markup += "<th scope=\"row\"" + Attribute("class", cell.css_class) + ">" + Escape(cell.text) + "</th>";
        continue;
      }
      const std::string space = classes[column].empty() || cell.css_class.empty() ? "" : " ";
      markup += "<td" + Attribute("class", classes[column] + space + cell.css_class) + ">" + Escape(cell.text) + "</td>";
    }
    markup += "</tr>\n";
  }
  return markup + "</tbody>\n</table></div>\n";
}

}  // namespace lookout::eval
