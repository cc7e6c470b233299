#include "app/report/text/offset_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/base/text.h"
#include "app/base/version.h"
#include "app/setup/control/offset_differences.h"
#include "core/base/math.h"

namespace app {
namespace {

using OffsetJson = nlohmann::ordered_json;

std::string cell_of(const std::optional<double>& value) {
    return value ? fmt::format("{:.3f}", *value) : "-";
}

/// What the control has more, without the rounding errors of the subtraction.
std::optional<double> difference_of(const ComparedOffset& value) {
    if (!value.setup || !value.control) return std::nullopt;
    constexpr double finest = 1e6;
    return core::round((*value.control - *value.setup) * finest) / finest;
}

std::string difference_cell(const ComparedOffset& value) {
    const auto difference = difference_of(value);
    if (!difference) return "-";
    const std::string text = fmt::format("{:+.3f}", *difference);
    return text == "+0.000" || text == "-0.000" ? "0.000" : text;
}

std::string remark_on(const ComparedOffset& value) {
    if (value.state == OffsetState::equal) return {};
    const std::string place =
        value.file.empty() ? std::string()
                           : fmt::format(" ({}, line {})", printable(value.file), value.line);
    return fmt::format("   {}{}", name_of(value.state), place);
}

std::string offset_row(const ComparedOffset& value) {
    return fmt::format("{:<16}{:>12}{:>12}{:>12}{}\n", value.name, cell_of(value.setup),
                       cell_of(value.control), difference_cell(value), remark_on(value));
}

std::string summary_of(const OffsetComparison& comparison) {
    const size_t all = comparison.values.size(), differing = comparison.differences();
    if (all == 0) return "Nothing was compared.\n";
    if (differing == 0) return fmt::format("All of the {} are equal.\n", counted(all, "value"));
    return fmt::format("{} of {} {} not agree.\n", differing, counted(all, "value"),
                       differing == 1 ? "does" : "do");
}

OffsetJson number_or_null(const std::optional<double>& value) {
    return value ? OffsetJson(*value) : OffsetJson(nullptr);
}

OffsetJson json_of(const ComparedOffset& value) {
    OffsetJson json = {{"name", value.name},
                       {"unit", value.is_angle ? "deg" : "mm"},
                       {"setup", number_or_null(value.setup)},
                       {"control", number_or_null(value.control)},
                       {"difference", number_or_null(difference_of(value))},
                       {"state", name_of(value.state)}};
    if (!value.file.empty()) {
        json["file"] = utf8_text(value.file);
        json["line"] = value.line;
    }
    return json;
}

} // namespace

std::string offset_text(const OffsetComparison& comparison, const ComparedFiles& files) {
    std::string text =
        fmt::format("{:<16}{:>12}{:>12}{:>12}\n", "mm, degrees", "set-up", "control", "difference");
    for (const ComparedOffset& value : comparison.values) text += offset_row(value);
    if (comparison.values.empty()) text.clear();
    text += fmt::format("{}{}", text.empty() ? "" : "\n", summary_of(comparison));
    const std::string setup =
        files.setup.empty() ? "inferred from the program" : printable(files.setup);
    text += wrapped("Set-up: " + setup, 0, 4);
    for (const std::string& note : comparison.notes)
        text += wrapped("Note: " + printable(note), 0, 4);
    return text;
}

std::string offset_json(const OffsetComparison& comparison, const ComparedFiles& files) {
    OffsetJson json = {
        {"schema", 1},
        {"feeler", version},
        {"setup", files.setup.empty() ? OffsetJson(nullptr) : OffsetJson(utf8_text(files.setup))},
        {"control", OffsetJson::array()},
        {"differences", comparison.differences()},
        {"values", OffsetJson::array()},
        {"notes", OffsetJson::array()}};
    for (const std::string& path : files.control) json["control"].push_back(utf8_text(path));
    for (const ComparedOffset& value : comparison.values) json["values"].push_back(json_of(value));
    for (const std::string& note : comparison.notes) json["notes"].push_back(utf8_text(note));
    return json.dump(2, ' ', false, OffsetJson::error_handler_t::replace) + "\n";
}

} // namespace app
