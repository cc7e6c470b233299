#pragma once

#include "app/viewer/view_model.h"

namespace app::viewer {

/// What a program is checked with where nobody has said it, in short lines: the stock, the tools,
/// and that no fixtures are known. Empty where a set-up says it, or nothing is open.
std::vector<std::string> inferred_summary(const ViewModel& model);

} // namespace app::viewer
