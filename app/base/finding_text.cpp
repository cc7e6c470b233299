#include "app/base/finding_text.h"

#include <fmt/format.h>

#include "app/base/text.h"

namespace app {

std::string finding_title(const core::Finding& finding, size_t width) {
    return fmt::format("{:<{}} {}", core::name_of(finding.severity), width, finding.rule);
}

std::string finding_location(uint32_t line, const std::string& file, const std::string& text,
                             size_t longest) {
    if (line == 0) return {};
    return fmt::format(", line {}{}: {}", line, file.empty() ? "" : " of " + trimmed(file),
                       clipped(trimmed(text), longest));
}

std::string cure_text(const core::Finding& finding) {
    return finding.cure.empty() ? finding.cure : "Cure: " + finding.cure;
}

} // namespace app
