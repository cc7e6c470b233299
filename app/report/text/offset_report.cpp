#include "app/report/text/offset_report.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/base/text.h"
#include "app/base/version.h"
#include "app/report/text/text_report.h"
#include "app/setup/control/offset_differences.h"
#include "core/base/math.h"
#include "gcode/language/modal_state.h"

namespace app {
namespace {

using OffsetJson = nlohmann::ordered_json;

/// Writes the values of the table: mm and degrees with three decimals, inches with four.
class OffsetCells {
public:
    explicit OffsetCells(gcode::LengthUnit unit) : unit_(unit) {}

    std::string row(const ComparedOffset& value) const;

private:
    bool is_inch(const ComparedOffset& value) const {
        return unit_ == gcode::LengthUnit::inch && !value.is_angle;
    }
    std::string cell(const ComparedOffset& value, double number) const {
        return is_inch(value) ? fmt::format("{:.4f}", gcode::from_mm(number, unit_))
                              : fmt::format("{:.3f}", number);
    }
    std::string cell(const ComparedOffset& value, const std::optional<double>& number) const {
        return number ? cell(value, *number) : "-";
    }
    std::string difference(const ComparedOffset& value) const;

    gcode::LengthUnit unit_;
};

/// What the control has more, without the rounding errors of the subtraction.
std::optional<double> difference_of(const ComparedOffset& value) {
    if (!value.setup || !value.control) return std::nullopt;
    constexpr double finest = 1e6;
    return core::round((*value.control - *value.setup) * finest) / finest;
}

std::string OffsetCells::difference(const ComparedOffset& value) const {
    const auto more = difference_of(value);
    if (!more) return "-";
    const std::string text = cell(value, std::abs(*more));
    const bool is_zero = text.find_first_not_of("0.") == std::string::npos;
    return (is_zero ? "" : *more > 0.0 ? "+" : "-") + text;
}

std::string remark_on(const ComparedOffset& value) {
    if (value.state == OffsetState::equal) return {};
    const std::string place =
        value.file.empty() ? std::string()
                           : fmt::format(" ({}, line {})", printable(value.file), value.line);
    return fmt::format("   {}{}", name_of(value.state), place);
}

std::string OffsetCells::row(const ComparedOffset& value) const {
    return fmt::format("{:<16}{:>12}{:>12}{:>12}{}\n", value.name, cell(value, value.setup),
                       cell(value, value.control), difference(value), remark_on(value));
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
    const OffsetCells cells(comparison.unit);
    const bool is_inch = comparison.unit == gcode::LengthUnit::inch;
    std::string text =
        fmt::format("{:<16}{:>12}{:>12}{:>12}\n", is_inch ? "inches, degrees" : "mm, degrees",
                    "set-up", "control", "difference");
    for (const ComparedOffset& value : comparison.values) text += cells.row(value);
    if (comparison.values.empty()) text.clear();
    text += fmt::format("{}{}", text.empty() ? "" : "\n", summary_of(comparison));
    if (comparison.stopped)
        text += wrapped("STOPPED: the program was not read to its end, and what it uses after "
                        "this place was not compared: "
                            + printable(error_text(*comparison.stopped)),
                        0, 4);
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
    if (comparison.stopped) json["stopped"] = utf8_text(error_text(*comparison.stopped));
    for (const std::string& path : files.control) json["control"].push_back(utf8_text(path));
    for (const ComparedOffset& value : comparison.values) json["values"].push_back(json_of(value));
    for (const std::string& note : comparison.notes) json["notes"].push_back(utf8_text(note));
    return json.dump(2, ' ', false, OffsetJson::error_handler_t::replace) + "\n";
}

} // namespace app
