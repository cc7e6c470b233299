#include "app/report/finding_line.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/report/text_layout.h"

namespace app {

std::string finding_line(const KeptFinding& finding) {
    std::string text = fmt::format("{} {}", core::name_of(finding.severity), finding.rule);
    if (finding.line == 0) return text;
    text += fmt::format(", line {}", finding.line);
    if (!finding.file.empty()) text += " of " + trimmed(finding.file);
    return text + ": " + clipped(trimmed(finding.text), 40);
}

nlohmann::ordered_json findings_json(const std::vector<KeptFinding>& findings) {
    ProgramResult holder;
    holder.findings = findings;
    return nlohmann::ordered_json::parse(json_of(holder)).at("findings");
}

} // namespace app
