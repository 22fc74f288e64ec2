// A turn from above, twice: the truth, and what a method made of it.
#pragma once

#include <string>

#include "tools/eval/results.hpp"

namespace lookout::eval {

/// Markup of a <figure>: both plans on one scale, bow up, and a table of the objects that came off worst.
///
/// Objects with a return are numbered by bearing, so that neighbours differ in colour. A segment has the colour of the object that it shares most
/// returns with; a dashed outline round it means that the object has another segment of larger IoU. Segments without a return of an object have the
/// colour of text. Turns whose arrays do not fit each other give a sentence instead of the plans.
///
/// @param method  name of the method, as plain text
std::string FigureOfWorstTurn(const WorstScan& turn, const std::string& method);

}  // namespace lookout::eval
