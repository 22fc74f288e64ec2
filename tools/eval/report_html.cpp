#include "tools/eval/report_html.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tools/eval/html.hpp"
#include "tools/eval/report_html_sections.hpp"
#include "tools/eval/report_html_style.hpp"
#include "tools/eval/table.hpp"

namespace lookout::eval {
namespace {

struct Section {
  std::string id;  // of the link to it
  std::string title;
  std::string markup;
};

std::string Entry(std::string_view name, const std::string& markup) { return "<dt>" + Escape(name) + "</dt><dd>" + markup + "</dd>\n"; }

std::string SecondWorld(const Results& results) {
  std::string markup;
  for (const auto& world : results.other_worlds) {
    std::string text = world.is_here ? "" : "not here";
    for (const auto& note : world.notes) text += (text.empty() ? "" : "; ") + note;
    markup += Entry(world.world, Escape(text));
  }
  return markup;
}

std::string WhatWasRun(const Results& results) {
  const auto or_dash = [](const std::string& text) { return text.empty() ? std::string("-") : Escape(text); };
  std::string scenes;
  for (const auto& scene : results.scenes) scenes += (scenes.empty() ? "" : ", ") + scene;
  std::string seeds = "-";
  if (results.num_seeds > 0) {
    const auto last = results.first_seed + static_cast<std::uint64_t>(results.num_seeds) - 1;
    seeds = std::to_string(results.num_seeds) + " a scene (" + std::to_string(results.first_seed) + " to " + std::to_string(last) + "), " +
            Number(results.seconds, 1) + " s each";
  }
  std::int64_t num_scans = 0;
  for (const auto& method : results.methods) {
    std::int64_t count = 0;
    for (const auto& [scene, score] : method.by_scene) count += score.num_scans;
    num_scans = std::max(num_scans, count);
  }
  return "<dl>\n" + Entry("command", results.command.empty() ? "-" : "<code>" + Escape(results.command) + "</code>") +
         Entry("version", or_dash(results.version)) + Entry("computer", or_dash(results.computer)) + Entry("scenes", or_dash(scenes)) +
         Entry("seeds", Escape(seeds)) + Entry("methods", Number(static_cast<std::int64_t>(results.methods.size()))) +
         Entry("turns a method", Number(num_scans)) + SecondWorld(results) + "</dl>\n";
}

std::string Definitions() {
  // The words of tools/eval/README.md, in short.
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 15> kDefinitions{{
      {"IoU",
       "Of a true object and a segment: the returns that both have, through the returns that at least one of them has. The IoU of an object is that "
       "with "
       "the segment for which it is largest; 0 when no segment holds any of it."},
      {"mIoU",
       "The paper's equation: the mean of the IoU over the true objects with a return in a turn, then over the turns of a scene. The mean over "
       "scenes "
       "counts each scene with objects the same."},
      {"object in the water", "Boats, kayaks, swimmers, buoys, markers. Land, docks, piers and walls are not."},
      {"return of no object", "Strays, rain, spray, glints, crests, wakes and the own boat. They are no objects; in a segment they lower its IoU."},
      {"false segment",
       "A segment without a return of any object; one of the own boat is false too. In captures of the second world the own boat's returns are taken "
       "out "
       "by their truth before a method sees them."},
      {"all segments, sure only",
       "Two operating points of one method, each in a row of its own: every segment counts, or those alone that the method does "
       "not take for tentative. The others have one: every segment counts."},
      {"second world", "Captures with truth, made by others than our simulator's authors."},
      {"thing with a segment", "An object with 5 returns or more in a turn, whose returns are more than half of some segment."},
      {"over-segmented", "An object of which two or more segments hold a tenth each."},
      {"under-segmenting", "A segment that holds a tenth each of two or more objects."},
      {"true positives", "The share of the objects' returns that are in a segment of which their object has most returns."},
      {"recall at IoU 0.5", "The share of object-turns whose IoU is 0.5 or more, by the range of the object's nearest return, in bins of 10 m."},
      {"component", "Of methods that search first and cluster then: what the search gave."},
      {"time", "Of labelling one turn, on one core, without rendering, decoding and judging. The 99th percentile is of the nearest rank."},
      {"points kept",
       "Of the first whole turn of each seed: returns that keep their pixel of the range image; the distance is from the point of a pixel to the "
       "nearest return, without sign."},
  }};
  std::string markup = "<dl>\n";
  for (const auto& [name, text] : kDefinitions) markup += Entry(name, Escape(text));
  return markup + "</dl>\n";
}

// A section for each world, ours first.
std::string InEachWorld(const Results& results, const std::function<std::string(const Results&)>& section) {
  std::string markup = section(results);
  for (const auto& world : results.other_worlds) {
    const auto more = world.is_here ? section(world) : Element("p", "Not here.");
    if (!more.empty()) markup += Element("h3", world.world) + more;
  }
  return markup;
}

}  // namespace

void WriteHtml(const Results& results, std::ostream& out) {
  const auto in_each = [&results](const std::function<std::string(const Results&)>& section) { return InEachWorld(results, section); };
  const std::vector<Section> sections{
      {"run", "What was run", WhatWasRun(results)},
      {"summary", "Summary", in_each([](const Results& world) { return page::Summary(world) + page::AgainstPeers(world) + page::Bars(world); })},
      {"table-1", "Table I: methods and scenes", page::TableOne(results)},
      {"water", "Objects in the water, and kinds", page::WaterAndKinds(results)},
      {"segments", "False, cut and merged segments", page::SegmentCounts(results)},
      {"range", "By range", in_each([](const Results& world) { return page::ByRange(world) + page::NearRecall(world); })},
      {"table-2", "Table II: projections", in_each(page::TableTwo)},
      {"table-3", "Table III: time by stage", in_each(page::TableThree)},
      {"ablation", "Ablation", in_each(page::Ablation)},
      {"curves", "Tests of the paper, and sweeps", page::Curves(results)},
      {"worst", "Worst turns", in_each(page::WorstTurns)},
      {"definitions", "Definitions", Definitions()},
  };
  out << "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      << "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>Lookout: segmentation judged</title>\n<style>"
      << page::kStyle << "</style>\n</head>\n<body>\n<header>\n<h1>Lookout: segmentation judged</h1>\n<nav aria-label=\"Contents\"><ul>\n";
  for (const auto& section : sections) {
    if (!section.markup.empty()) out << "<li><a href=\"#" << section.id << "\">" << Escape(section.title) << "</a></li>\n";
  }
  out << "</ul></nav>\n</header>\n<main>\n";
  for (const auto& section : sections) {
    if (section.markup.empty()) continue;
    out << "<section id=\"" << section.id << "\">\n" << Element("h2", section.title) << section.markup << "</section>\n";
  }
  out << "</main>\n</body>\n</html>\n";
}

}  // namespace lookout::eval
