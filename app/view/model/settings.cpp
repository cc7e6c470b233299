#include "app/view/model/settings.h"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>

#include "app/setup/toml_file.h"
#include "core/base/file_reads.h"

namespace app::viewer {
namespace {

template <typename T>
void take(const toml::table& table, std::string_view name, T& value) {
    if (const auto found = table[name].value<T>()) value = *found;
}

void take_within(const toml::table& table, std::string_view name, double& value, double least,
                 double largest) {
    double found = value;
    take(table, name, found);
    if (found >= least && found <= largest) value = found;
}

void take_within(const toml::table& table, std::string_view name, int& value, int least,
                 int largest) {
    int found = value;
    take(table, name, found);
    if (found >= least && found <= largest) value = found;
}

} // namespace

Settings settings_in(const std::string& text) {
    Settings settings;
    const auto parsed = parsed_toml(text);
    if (!parsed) return settings; // as if there were no file
    const toml::table& table = *parsed;
    std::string word;
    take(table, "theme", word);
    if (word == "light") settings.theme = render::ColorScheme::light;
    take(table, "projection", word);
    if (word == "parallel") settings.projection = render::Projection::orthographic;
    take(table, "inch", settings.inch);
    settings.has_own_unit = settings.inch;
    take(table, "own_unit", settings.has_own_unit);
    take_within(table, "scale", settings.scale, least_scale, largest_scale);
    int mouse = 0;
    take_within(table, "mouse", mouse, 0, 2);
    settings.mouse = static_cast<MousePreset>(mouse);
    take_within(table, "width", settings.width, 320, 20000);
    take_within(table, "height", settings.height, 240, 20000);
    take_within(table, "x", settings.x, -20000, 20000);
    take_within(table, "y", settings.y, -20000, 20000);
    take(table, "maximised", settings.maximised);
    take_within(table, "list_width", settings.list_width, 120.0, 2000.0);
    take_within(table, "inspector_width", settings.inspector_width, 120.0, 2000.0);
    take_within(table, "device_width", settings.device_width, 120.0, 2000.0);
    take_within(table, "timeline_height", settings.timeline_height, 60.0, 1000.0);
    take(table, "system_dialog", settings.system_dialog);
    take(table, "show_stock", settings.shown.stock);
    take(table, "show_fixtures", settings.shown.fixtures);
    take(table, "show_tool", settings.shown.tool);
    take(table, "show_machine", settings.shown.machine);
    take(table, "show_path", settings.shown.path);
    take(table, "show_witness", settings.shown.witness);
    take(table, "holder_xray", settings.shown.holder_xray);
    take(table, "show_ground", settings.shown.ground);
    take(table, "show_zeros", settings.shown.zeros);
    return settings;
}

std::string text_of(const Settings& s) {
    const VisibleParts& shown = s.shown;
    return fmt::format(
        "# Settings of feeler view, saved when the window was last closed.\n"
        "theme = \"{}\"\nprojection = \"{}\"\ninch = {}\nown_unit = {}\nscale = {:.2f}\nmouse = "
        "{}\n"
        "width = {}\nheight = {}\nx = {}\ny = {}\nmaximised = {}\n"
        "list_width = {:.1f}\ninspector_width = {:.1f}\ndevice_width = {:.1f}\ntimeline_height = "
        "{:.1f}\n"
        "system_dialog = {}\nshow_stock = {}\nshow_fixtures = {}\nshow_tool = {}\nshow_machine = "
        "{}\n"
        "show_path = {}\nshow_witness = {}\nholder_xray = {}\n"
        "show_ground = {}\nshow_zeros = {}\n",
        s.theme == render::ColorScheme::light ? "light" : "dark",
        s.projection == render::Projection::orthographic ? "parallel" : "perspective", s.inch,
        s.has_own_unit, s.scale, static_cast<int>(s.mouse), s.width, s.height, s.x, s.y,
        s.maximised, s.list_width, s.inspector_width, s.device_width, s.timeline_height,
        s.system_dialog, shown.stock, shown.fixtures, shown.tool, shown.machine, shown.path,
        shown.witness, shown.holder_xray, shown.ground, shown.zeros);
}

Settings read_settings(const std::filesystem::path& file) {
    return settings_in(core::file_bytes(file).value_or(""));
}

void write_settings(const Settings& settings, const std::filesystem::path& file) {
    if (file.empty()) return;
    std::error_code ignored; // no one is left to report it to: the window is closing
    std::filesystem::create_directories(file.parent_path(), ignored);
    std::ofstream(file) << text_of(settings);
}

} // namespace app::viewer
