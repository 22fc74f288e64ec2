// The page without its data.
#pragma once

#include <string_view>

namespace lookout::eval {

/// The JSON goes where {{results}} stands. `./dev web` builds it from lab/eval/page.
extern const std::string_view kPageTemplate;

}  // namespace lookout::eval
