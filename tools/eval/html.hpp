// Pieces of an HTML page. What comes in is plain text and is escaped here; what goes out is markup that is also well-formed XML.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lookout::eval {

/// Markup of a text in elements and in quoted attributes. Control characters, which no page may hold, become U+FFFD.
std::string Escape(std::string_view text);

/// <name>text</name>, with a line end.
std::string Element(std::string_view name, std::string_view text);

struct HtmlCell {
  std::string text;
  std::string css_class = {};  // of the style of the page, "" = none
};

class HtmlTable {
 public:
  struct Heading {
    std::string text;
    bool is_upright = false;  // written from below to above, for narrow columns
  };

  HtmlTable(std::string caption, std::vector<Heading> headings) : caption_(std::move(caption)), headings_(std::move(headings)) {}

  /// Precondition: as many cells as headings. The first one is the heading of the row. Columns of
  /// numbers and dashes alone stand to the right, others to the left.
  void Add(std::vector<HtmlCell> row) { rows_.push_back(std::move(row)); }
  bool empty() const { return rows_.empty(); }

  std::string Markup() const;

 private:
  std::string caption_;
  std::vector<Heading> headings_;
  std::vector<std::vector<HtmlCell>> rows_;
};

}  // namespace lookout::eval
