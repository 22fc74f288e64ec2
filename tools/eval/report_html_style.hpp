// The style of the report page: light, dark, and on paper.
#pragma once

#include <string_view>

namespace lookout::eval::page {

// Colours of series after Okabe and Ito, "Color Universal Design" (2008), without black: blue, orange, green, purple, vermilion, sky blue, yellow. On
// white, the bright ones are darker than there, for a contrast of 3 : 1 and more (WCAG 2.1, 1.4.11); on dark ground blue and green are lighter.
inline constexpr std::string_view kStyle = R"css(
:root { color-scheme: light dark; --ground: #ffffff; --text: #1b1f24; --faint: #5b6570; --rule: #d5dae0; --grid: #e6e9ed; --loose: #b4bcc6; --band: #f4f6f8;
  --shade: 0, 114, 178; --link: #00598c;
  --s0: #0072b2; --s1: #c07a00; --s2: #009e73; --s3: #b3548a; --s4: #d55e00; --s5: #2f93d1; --s6: #857c00; }
@media (prefers-color-scheme: dark) {
  :root { --ground: #14181d; --text: #e4e8ec; --faint: #9aa5b1; --rule: #3a434d; --grid: #29313a; --loose: #56616d; --band: #1c2229; --shade: 86, 180, 233;
    --link: #7cc4f0;
    --s0: #3f9fdf; --s1: #e69f00; --s2: #1fbf92; --s3: #cc79a7; --s4: #ee7a2b; --s5: #8fd0f7; --s6: #f0e442; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 24px 20px 60px; max-width: 1240px; background: var(--ground); color: var(--text);
  font: 15px/1.5 system-ui, "Segoe UI", "Helvetica Neue", "DejaVu Sans", Arial, sans-serif; }
h1 { font-size: 27px; line-height: 1.2; margin: 0 0 12px; }
h2 { font-size: 20px; margin: 44px 0 12px; padding-top: 8px; border-top: 2px solid var(--rule); }
p { max-width: 80ch; margin: 8px 0; }
a { color: var(--link); }
code { font-family: ui-monospace, "DejaVu Sans Mono", monospace; font-size: 13px; overflow-wrap: anywhere; }
nav ul { display: flex; flex-wrap: wrap; gap: 2px 18px; padding: 0; margin: 16px 0 0; list-style: none; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 3px 18px; margin: 8px 0; }
dt { color: var(--faint); }
dd { margin: 0; max-width: 90ch; overflow-wrap: anywhere; }
.note { color: var(--faint); font-size: 13px; }
.wide { overflow-x: auto; margin: 14px 0 18px; }
table { border-collapse: collapse; font-size: 13px; font-variant-numeric: tabular-nums; }
caption { text-align: left; font-weight: 600; padding: 0 0 6px; white-space: nowrap; }
th, td { padding: 3px 8px; border-bottom: 1px solid var(--rule); text-align: right; white-space: nowrap; }
thead th { vertical-align: bottom; color: var(--faint); font-weight: 600; border-bottom: 2px solid var(--rule); white-space: normal; max-width: 130px; }
thead th.upright { padding: 4px 8px; }
thead th.upright span { writing-mode: vertical-rl; transform: rotate(180deg); display: inline-block; white-space: nowrap; text-align: left; line-height: 1.2; }
th[scope=row] { text-align: left; font-weight: 400; }
thead th:first-child, th.words, td.words { text-align: left; }
td.two { white-space: pre-line; line-height: 1.25; }
tr:hover > * { background-color: var(--band); }
th.ours { font-weight: 700; }
.best { font-weight: 700; text-decoration: underline; text-underline-offset: 2px; }
th.total, td.total { font-weight: 600; border-bottom: 2px solid var(--rule); }
td.h0, td.h1, td.h2 { background: rgba(var(--shade), 0); } td.h3 { background: rgba(var(--shade), .04); } td.h4 { background: rgba(var(--shade), .08); }
td.h5 { background: rgba(var(--shade), .13); } td.h6 { background: rgba(var(--shade), .18); } td.h7 { background: rgba(var(--shade), .24); }
td.h8 { background: rgba(var(--shade), .31); } td.h9 { background: rgba(var(--shade), .4); }
figure { margin: 18px 0 28px; }
figcaption { font-weight: 600; font-size: 14px; margin-bottom: 6px; }
figure.pair { display: flow-root; }
.side { float: left; width: calc(50% - 8px); } .side + .side { margin-left: 16px; }
.side p { margin: 0 0 4px; color: var(--faint); font-size: 13px; }
figure.pair .wide { clear: both; padding-top: 8px; }
svg { display: block; height: auto; width: 100%; }
svg.chart { max-width: 860px; }
svg text { font-family: inherit; font-size: 12px; fill: var(--text); }
svg text.small { font-size: 10px; fill: var(--faint); }
.axis { stroke: var(--faint); stroke-width: 1; fill: none; } .grid { stroke: var(--grid); stroke-width: 1; fill: none; }
.line { fill: none; stroke-width: 1.4; stroke-linejoin: round; } .line.bold { stroke-width: 3; }
.marker { stroke-width: 1.4; } .bar { stroke: none; }
svg.plan { border: 1px solid var(--rule); }
svg.plan .grid { stroke-width: 1; }
svg.plan text { font-size: 11px; text-anchor: middle; paint-order: stroke; stroke: var(--ground); stroke-width: 3px; stroke-linejoin: round; }
svg.plan text.label { font-weight: 700; } svg.plan text.ring { fill: var(--faint); }
.dots { fill: none; stroke-width: 3; stroke-linecap: round; } .dots.loose { stroke-width: 2.2; }
.outline { fill: none; stroke-width: 1; stroke-linejoin: round; } .outline.dashed { stroke-dasharray: 3.5 2.5; }
.boat { fill: var(--text); stroke: var(--ground); stroke-width: 1; }
.s0 { --c: var(--s0); } .s1 { --c: var(--s1); } .s2 { --c: var(--s2); } .s3 { --c: var(--s3); } .s4 { --c: var(--s4); } .s5 { --c: var(--s5); }
.s6 { --c: var(--s6); } .loose { --c: var(--loose); } .false { --c: var(--text); }
.line, .marker, .dots, .outline { stroke: var(--c); } .marker, .bar { fill: var(--c); }
ul.legend { display: flex; flex-wrap: wrap; gap: 2px 16px; margin: 6px 0 0; padding: 0; list-style: none; font-size: 13px; }
ul.legend li { display: flex; align-items: center; gap: 5px; }
svg.key { width: 30px; height: 12px; flex: none; }
details { margin-top: 6px; font-size: 13px; } summary { cursor: pointer; color: var(--faint); }
@media (max-width: 700px) { .side { float: none; width: 100%; } .side + .side { margin: 12px 0 0; } dl { grid-template-columns: 1fr; } dd { margin-bottom: 6px; } }
@media print {
  @page { size: A4 landscape; margin: 12mm; }
  :root { color-scheme: light; --ground: #ffffff; --text: #000000; --faint: #444444; --rule: #b9bfc6; --grid: #dddddd; --loose: #aab2bb; --shade: 0, 114, 178;
    --s0: #0072b2; --s1: #c07a00; --s2: #009e73; --s3: #b3548a; --s4: #d55e00; --s5: #2f93d1; --s6: #857c00; }
  body { max-width: none; padding: 0; font-size: 11px; } table { font-size: 9.5px; } th, td { padding: 2px 4px; }
  body, td { -webkit-print-color-adjust: exact; print-color-adjust: exact; }
  nav, details { display: none; } .wide { overflow: visible; } figure, .wide, tr { break-inside: avoid; } h2, caption, figcaption { break-after: avoid; }
  svg.chart { max-width: 200mm; max-height: 150mm; } figure.pair { max-width: 230mm; } }
)css";

}  // namespace lookout::eval::page
