#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/sim/finding.h"

namespace app {

/// "error near-miss": severity and rule, with which the text of a finding begins. The severity
/// takes at least `width` characters.
std::string finding_title(const core::Finding& finding, size_t width = 0);

/// Where a finding is, after its title: ", line 12 of sub.nc: G0 Z5."; empty for line 0, if it is
/// about the program as a whole. `file` is that of a subprogram; of the block's text at most
/// `longest` bytes are shown.
std::string finding_location(uint32_t line, const std::string& file, const std::string& text,
                             size_t longest = 40);

/// "Cure: Raise Z."; empty without a cure.
std::string cure_text(const core::Finding& finding);

} // namespace app
