#include "app/report/html/html_page.h"

#include <fmt/format.h>

#include "render/palette.h"

namespace app {

std::string filled_page(std::string_view page, const PageValues& fillings) {
    std::string text;
    while (true) {
        const size_t open = page.find("{{");
        if (open == page.npos) return text += page;
        const size_t close = page.find("}}", open);
        text += page.substr(0, open);
        text += fillings.at(std::string(page.substr(open + 2, close - open - 2)));
        page = page.substr(close + 2);
    }
}

namespace {

using render::Role;

struct Variable {
    const char* name;
    Role role;
};

constexpr Variable variables[] = {{"background", Role::background},
                                  {"panel", Role::panel},
                                  {"raised", Role::raised},
                                  {"line", Role::line},
                                  {"text", Role::text},
                                  {"dim", Role::dim},
                                  {"accent", Role::accent},
                                  {"violation", Role::violation},
                                  {"near", Role::near},
                                  {"clear", Role::clear},
                                  {"view-top", Role::view_top},
                                  {"view-bottom", Role::view_bottom},
                                  {"stock", Role::stock_raw},
                                  {"stock-cut", Role::stock_cut},
                                  {"fixture", Role::fixture},
                                  {"vise", Role::vise},
                                  {"clamp", Role::clamp},
                                  {"flutes", Role::flutes},
                                  {"shank", Role::shank},
                                  {"holder", Role::holder},
                                  {"nose", Role::nose},
                                  {"machine", Role::machine},
                                  {"part", Role::part},
                                  {"edge", Role::edge},
                                  {"rapid", Role::rapid},
                                  {"current", Role::current},
                                  {"pair-tool", Role::pair_tool},
                                  {"pair-body", Role::pair_body}};

std::string declarations(render::ColorScheme theme) {
    std::string text;
    for (const Variable& variable : variables) {
        const render::Color color = render::color(theme, variable.role);
        text += fmt::format("--{}:#{:02x}{:02x}{:02x};", variable.name, color.r, color.g, color.b);
    }
    // Yellow letters are unreadable on white.
    const render::Color near = render::color(theme, Role::near);
    const render::Color letters =
        theme == render::ColorScheme::light ? render::mixed(near, {0, 0, 0}, 0.4) : near;
    return text + fmt::format("--near-text:#{:02x}{:02x}{:02x};", letters.r, letters.g, letters.b);
}

} // namespace

std::string html_palette() {
    const std::string light = declarations(render::ColorScheme::light),
                      dark = declarations(render::ColorScheme::dark);
    return fmt::format(":root{{{0}}}\n"
                       "@media screen and (prefers-color-scheme:dark)"
                       "{{:root:not([data-theme=light]){{{1}}}}}\n"
                       "@media screen{{:root[data-theme=dark]{{{1}}}}}",
                       light, dark);
}

} // namespace app
