#include "app/report/warning_log.h"

#include <fmt/format.h>

#include "app/report/text_report.h"

namespace app {
namespace {

constexpr uint64_t said_places = 10;     // of one message
constexpr size_t most_messages = 10'000; // that are told from each other

} // namespace

std::string WarningLog::line_for(const gcode::Warning& warning, std::string_view file) {
    auto found = counts_.find(warning.message);
    if (found == counts_.end()) {
        if (counts_.size() == most_messages) {
            ++others_;
            return {};
        }
        found = counts_.emplace(warning.message, 0).first;
    }
    if (++found->second > said_places) return {};
    const std::string cure = warning.cure.empty() ? "" : " (" + warning.cure + ")";
    return error_text(
               {core::ErrorCode::syntax, warning.where, warning.message + cure, std::string(file)})
           + "\n";
}

std::string WarningLog::rest() const {
    std::string text;
    for (const auto& [message, count] : counts_)
        if (count > said_places)
            text += fmt::format("{} more times: {}\n", count - said_places, message);
    if (others_ > 0) text += fmt::format("and {} other warnings\n", others_);
    return text;
}

} // namespace app
