#include "app/viewer/fonts.h"

#include <filesystem>

#include <imgui.h>
#include <imgui_freetype.h>

namespace app::viewer {
namespace {

constexpr const char* inter = "/usr/share/fonts/opentype/inter/Inter-Regular.otf";
constexpr const char* inter_strong = "/usr/share/fonts/opentype/inter/Inter-SemiBold.otf";
constexpr const char* inter_big = "/usr/share/fonts/opentype/inter/InterDisplay-SemiBold.otf";
constexpr const char* jetbrains =
    "/usr/share/fonts/truetype/jetbrains-mono/JetBrainsMono-Regular.ttf";
constexpr const char* awesome = "/usr/share/fonts/truetype/font-awesome/fontawesome-webfont.ttf";

/// What programs, names and units are written in. Zero ends it.
constexpr ImWchar letters[] = {0x0020, 0x017F, 0x0370, 0x04FF, 0x2010, 0x2027, 0x2030, 0x2044,
                               0x2070, 0x20BF, 0x2190, 0x2199, 0x2200, 0x2265, 0};
constexpr ImWchar digits[] = {0x0020, 0x007E, 0x2013, 0x2014, 0x2265, 0x2265, 0};
constexpr ImWchar icons[] = {0xF000, 0xF2E0, 0};

bool is_there(const char* path) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored);
}

ImFont* load(const char* path, double size, const ImWchar* ranges) {
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    const auto pixels = static_cast<float>(size);
    if (is_there(path))
        if (ImFont* font = atlas.AddFontFromFileTTF(path, pixels, nullptr, ranges)) return font;
    ImFontConfig config;
    config.SizePixels = pixels;
    return atlas.AddFontDefault(&config);
}

/// Puts the icons into the font that was loaded last.
bool merge_icons(double size) {
    if (!is_there(awesome)) return false;
    ImFontConfig config;
    config.MergeMode = true;
    config.GlyphMinAdvanceX = static_cast<float>(size);
    config.GlyphOffset.y = static_cast<float>(0.06 * size);
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    return atlas.AddFontFromFileTTF(awesome, static_cast<float>(size), &config, icons) != nullptr;
}

struct IconText {
    const char *glyph, *plain;
};

IconText text_of(Icon icon) {
    switch (icon) {
    case Icon::program:
        return {"\xEF\x82\x85", "NC"};
    case Icon::first:
        return {"\xEF\x81\x89", "|<"};
    case Icon::previous:
        return {"\xEF\x81\x88", "<"};
    case Icon::play:
        return {"\xEF\x81\x8B", ">>"};
    case Icon::pause:
        return {"\xEF\x81\x8C", "||"};
    case Icon::next:
        return {"\xEF\x81\x91", ">"};
    case Icon::last:
        return {"\xEF\x81\x90", ">|"};
    case Icon::warning:
        return {"\xEF\x81\xB1", "!"};
    case Icon::near:
        return {"\xEF\x81\xAA", "~"};
    case Icon::section:
        return {"\xEF\x83\x84", "cut"};
    case Icon::question:
        return {"\xEF\x84\xA8", "?"};
    case Icon::picture:
        return {"\xEF\x80\xB0", "pic"};
    case Icon::settings:
        return {"\xEF\x80\x93", "set"};
    case Icon::moon:
        return {"\xEF\x86\x86", "dark"};
    case Icon::sun:
        return {"\xEF\x86\x85", "light"};
    case Icon::search:
        return {"\xEF\x80\x82", "/"};
    case Icon::breakpoint:
        return {"\xEF\x84\x91", "o"};
    case Icon::bookmark:
        return {"\xEF\x80\xAE", "*"};
    case Icon::measure:
        return {"\xEF\x81\xBE", "|-|"};
    case Icon::check:
        return {"\xEF\x80\x8C", "+"};
    case Icon::close:
        return {"\xEF\x80\x8D", "x"};
    case Icon::open:
        return {"\xEF\x81\xBC", "open"};
    case Icon::locate:
        return {"\xEF\x81\x9B", "()"};
    case Icon::undo:
        return {"\xEF\x83\xA2", "undo"};
    case Icon::chevron:
        return {"\xEF\x81\x94", ">"};
    case Icon::note:
        return {"\xEF\x81\x9A", "i"};
    case Icon::bulb:
        return {"\xEF\x83\xAB", "->"};
    case Icon::changed:
        return {"\xEF\x84\x91", "*"};
    case Icon::device:
        return {"\xEF\x8B\x9B", "dev"};
    }
    return {"", ""};
}

} // namespace

const char* Fonts::icon(Icon icon) const {
    const IconText known = text_of(icon);
    return has_icons ? known.glyph : known.plain;
}

Fonts load_fonts(double scale) {
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    atlas.Clear();
    atlas.FontBuilderIO = ImGuiFreeType::GetBuilderForFreeType();
    atlas.FontBuilderFlags = ImGuiFreeTypeBuilderFlags_LightHinting;
    Fonts fonts;
    fonts.scale = scale;
    fonts.text = load(inter, 15.0 * scale, letters);
    fonts.has_icons = merge_icons(14.0 * scale);
    fonts.small = load(inter, 12.5 * scale, letters);
    merge_icons(11.5 * scale);
    fonts.strong = load(inter_strong, 15.0 * scale, letters);
    merge_icons(14.0 * scale);
    fonts.big = load(inter_big, 38.0 * scale, digits);
    fonts.mono = load(jetbrains, 14.5 * scale, letters);
    atlas.Build();
    return fonts;
}

} // namespace app::viewer
