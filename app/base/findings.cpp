#include "app/base/findings.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/base/rule_table.h"

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

bool is_error_of_program(const core::Finding& finding) {
    return finding.severity == core::Severity::error
           && finding.rule != core::rule_id("incomplete-setup");
}

bool lacks_coverage(const core::Finding& finding) {
    return finding.severity == core::Severity::error && !is_error_of_program(finding);
}

std::tuple<std::string, std::string, std::string> subject_of(const core::Finding& finding) {
    return {finding.rule, finding.pair[0].empty() ? finding.message : finding.pair[0],
            finding.pair[1]};
}

} // namespace app
