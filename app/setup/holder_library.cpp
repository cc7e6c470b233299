#include "app/setup/holder_library.h"

#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/setup/table_reader.h"
#include "app/setup/toml_file.h"
#include "gcode/language/modal_state.h"

namespace app {

namespace {

std::vector<core::ConeStep> read_cones(TableReader& table) {
    std::vector<core::ConeStep> cones;
    for (const std::vector<double>& row : table.rows("cones", Measure::length, 3)) {
        const double wide = std::max(row[0], row[1]), narrow = std::min(row[0], row[1]);
        if (!(row[2] > 0.0 && wide > 0.0 && narrow >= 0.0))
            table.refuse("cones", "needs [lower diameter, upper diameter, length], all above 0");
        cones.push_back({row[0], row[1], row[2]});
    }
    return cones;
}

std::vector<core::ConeStep> read_profile(TableReader& table) {
    auto cones = cones_of_outline(table.rows("profile", Measure::length, 2), table.unit());
    if (cones) return *std::move(cones);
    table.refuse("profile", cones.error().message);
    return {};
}

void read_holder(TableReader& table, HolderLibrary& library) {
    const std::string name = table.string("name").value_or("");
    table.string("description");
    if (name.empty()) return table.need("name");
    if (table.has("cones") == table.has("profile"))
        return table.refuse_whole("needs either cones or profile");
    std::vector<core::ConeStep> cones =
        table.has("cones") ? read_cones(table) : read_profile(table);
    if (cones.empty()) table.refuse_whole("has no height");
    table.finish();
    if (!library.emplace(name, std::move(cones)).second)
        table.refuse("name", fmt::format("\"{}\" is defined twice", name));
}

core::Result<HolderLibrary> read_library(const toml::table& parsed) {
    HolderLibrary library;
    std::optional<core::Error> error;
    TableReader root(parsed, "holder library", error);
    root.read_unit();
    for (TableReader& table : root.tables("holder", "[[holder]]")) read_holder(table, library);
    root.finish();
    if (error) return tl::unexpected(*error);
    return library;
}

} // namespace

core::Result<HolderLibrary> read_holder_library(const std::string& path) {
    FEELER_TRY(const toml::table parsed, read_toml(path));
    auto library = read_library(parsed);
    if (!library && library.error().file.empty()) library.error().file = path;
    return library;
}

std::string names_like(const HolderLibrary& library, const std::string& name) {
    std::vector<std::string> like, all;
    const std::string start = name.substr(0, name.find('-'));
    for (const auto& [known, cones] : library) {
        all.push_back(known);
        if (known.starts_with(start)) like.push_back(known);
    }
    return fmt::format("{}", fmt::join(like.empty() ? all : like, " "));
}

core::Result<std::vector<core::ConeStep>>
cones_of_outline(const std::vector<std::vector<double>>& points, gcode::LengthUnit unit) {
    using core::ErrorCode;
    if (points.size() < 2)
        return core::fail(ErrorCode::invalid_value, "needs at least two [r, z] points");
    if (points[0][1] != 0.0)
        return core::fail(ErrorCode::invalid_value,
                          "must begin at z = 0, the lower end of this part");
    std::vector<core::ConeStep> cones;
    for (size_t i = 0; i < points.size(); ++i) {
        const double r = points[i][0], z = points[i][1];
        if (r < 0.0) return core::fail(ErrorCode::invalid_value, "has a negative r");
        if (i == 0) continue;
        const double r_below = points[i - 1][0], z_below = points[i - 1][1];
        if (z < z_below)
            return core::fail(ErrorCode::invalid_value,
                              fmt::format("must not go down: z falls from {:g} to {:g}",
                                          gcode::from_mm(z_below, unit), gcode::from_mm(z, unit)));
        if (z == z_below) continue;
        if (r == 0.0 && r_below == 0.0)
            return core::fail(ErrorCode::invalid_value,
                              fmt::format("has radius 0 from z = {:g} to {:g}",
                                          gcode::from_mm(z_below, unit), gcode::from_mm(z, unit)));
        cones.push_back({2.0 * r_below, 2.0 * r, z - z_below});
    }
    if (cones.empty()) return core::fail(ErrorCode::invalid_value, "has no height");
    return cones;
}

std::vector<core::ConeStep> cones_of_profile(const core::RevolvedProfile& profile) {
    std::vector<core::ConeStep> cones;
    for (const core::ProfileElement& e : profile.elements)
        cones.push_back({2.0 * e.r0, 2.0 * e.r1, e.z1 - e.z0});
    return cones;
}

} // namespace app
