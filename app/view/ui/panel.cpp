#include "app/view/ui/panel.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_freetype.h>

#include "app/view/model/block_row.h"
#include "app/view/model/view_model.h"
#include "core/base/platform.h"

namespace app::viewer {
namespace {

using render::Role;

ImU32 packed(const render::Color& color) { return IM_COL32(color.r, color.g, color.b, color.a); }

void set_colors(const Theme& palette, ImVec4* colors) {
    const ImVec4 clear(0, 0, 0, 0);
    colors[ImGuiCol_Text] = palette.vector(Role::text);
    colors[ImGuiCol_TextDisabled] = palette.vector(Role::dim);
    colors[ImGuiCol_TextSelectedBg] = palette.vector(Role::accent, 0.35);
    colors[ImGuiCol_WindowBg] = palette.vector(Role::panel);
    colors[ImGuiCol_ChildBg] = clear;
    colors[ImGuiCol_PopupBg] = palette.vector(Role::panel, 0.98);
    colors[ImGuiCol_Border] = palette.vector(Role::line);
    colors[ImGuiCol_FrameBg] = palette.vector(Role::raised);
    colors[ImGuiCol_FrameBgHovered] = palette.vector(Role::line);
    colors[ImGuiCol_FrameBgActive] = palette.vector(Role::line);
    colors[ImGuiCol_ScrollbarBg] = clear;
    colors[ImGuiCol_ScrollbarGrab] = palette.vector(Role::line);
    colors[ImGuiCol_ScrollbarGrabHovered] = palette.vector(Role::dim, 0.7);
    colors[ImGuiCol_ScrollbarGrabActive] = palette.vector(Role::dim);
    colors[ImGuiCol_CheckMark] = palette.vector(Role::accent);
    colors[ImGuiCol_SliderGrab] = palette.vector(Role::accent);
    colors[ImGuiCol_SliderGrabActive] = palette.vector(Role::accent);
    colors[ImGuiCol_Button] = palette.vector(Role::raised);
    colors[ImGuiCol_ButtonHovered] = palette.vector(Role::line);
    colors[ImGuiCol_ButtonActive] = palette.vector(Role::accent, 0.45);
    colors[ImGuiCol_Header] = palette.vector(Role::raised);
    colors[ImGuiCol_HeaderHovered] = palette.vector(Role::line);
    colors[ImGuiCol_HeaderActive] = palette.vector(Role::line);
    colors[ImGuiCol_Separator] = palette.vector(Role::line);
    colors[ImGuiCol_SeparatorHovered] = palette.vector(Role::accent, 0.6);
    colors[ImGuiCol_SeparatorActive] = palette.vector(Role::accent);
    colors[ImGuiCol_TitleBg] = colors[ImGuiCol_TitleBgActive] = palette.vector(Role::raised);
    colors[ImGuiCol_NavHighlight] = palette.vector(Role::accent);
    colors[ImGuiCol_ModalWindowDimBg] = ImVec4(0, 0, 0, 0.45F);
    colors[ImGuiCol_PlotHistogram] = palette.vector(Role::accent);
}

} // namespace

ImU32 Theme::color(Role role, double alpha) const {
    render::Color found = render::color(theme, role);
    return packed(render::with_alpha(found, alpha * found.a / 255.0));
}

ImVec4 Theme::vector(Role role, double alpha) const {
    return ImGui::ColorConvertU32ToFloat4(color(role, alpha));
}

ImU32 Theme::ink(Role role) const {
    const bool is_pale = role == Role::near && theme == render::ColorScheme::light;
    return is_pale ? mixed(role, Role::text, 0.55) : color(role);
}

ImU32 Theme::mixed(Role a, Role b, double fraction) const {
    return packed(render::mixed(render::color(theme, a), render::color(theme, b), fraction));
}

ImU32 Theme::of(const BlockRow& row, Role otherwise) const {
    if (is_offending(row)) return color(Role::violation);
    if (is_near(row)) return color(Role::near);
    return color(otherwise);
}

void apply_style(const Theme& palette, double scale) {
    ImGuiStyle style;
    style.WindowRounding = 6.0F;
    style.ChildRounding = 0.0F;
    style.FrameRounding = 5.0F;
    style.PopupRounding = 6.0F;
    style.GrabRounding = 4.0F;
    style.ScrollbarRounding = 4.0F;
    style.ScrollbarSize = 9.0F;
    style.WindowBorderSize = 0.0F;
    style.PopupBorderSize = 1.0F;
    style.WindowPadding = ImVec2(12, 12);
    style.FramePadding = ImVec2(9, 6);
    style.ItemSpacing = ImVec2(7, 7);
    style.ItemInnerSpacing = ImVec2(6, 4);
    style.DisabledAlpha = 0.4F;
    set_colors(palette, style.Colors);
    style.ScaleAllSizes(static_cast<float>(scale));
    ImGui::GetStyle() = style;
}

namespace {

// Files of fonts, in their folders of /usr/share/fonts.
constexpr const char* inter = "opentype/inter/Inter-Regular.otf";
constexpr const char* inter_strong = "opentype/inter/Inter-SemiBold.otf";
constexpr const char* inter_big = "opentype/inter/InterDisplay-SemiBold.otf";
constexpr const char* jetbrains = "truetype/jetbrains-mono/JetBrainsMono-Regular.ttf";
constexpr const char* awesome = "truetype/font-awesome/fontawesome-webfont.ttf";

/// Unicode ranges for programs, names and units. Zero ends the list.
constexpr ImWchar letters[] = {0x0020, 0x017F, 0x0370, 0x04FF, 0x2010, 0x2027, 0x2030, 0x2044,
                               0x2070, 0x20BF, 0x2190, 0x2199, 0x2200, 0x2265, 0};
constexpr ImWchar digits[] = {0x0020, 0x007E, 0x2013, 0x2014, 0x2265, 0x2265, 0};
constexpr ImWchar icons[] = {0xF000, 0xF2E0, 0};

/// The path of a font: beside the installed program, for an archive that was unpacked anywhere,
/// else in the system. Empty if it is in neither.
std::string font_file(const char* name) {
    namespace fs = std::filesystem;
    std::error_code ignored;
    const fs::path folder = core::platform::program_path().parent_path();
    const fs::path below = fs::path("share/feeler/fonts") / fs::path(name).filename();
    for (const fs::path& path :
         {folder.parent_path() / below, folder / below, fs::path("/usr/share/fonts") / name})
        if (fs::is_regular_file(path, ignored)) return path.generic_string();
    return {};
}

ImFont* load(const char* name, double size, const ImWchar* ranges) {
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    const auto pixels = static_cast<float>(size);
    if (const std::string path = font_file(name); !path.empty())
        if (ImFont* font = atlas.AddFontFromFileTTF(path.c_str(), pixels, nullptr, ranges))
            return font;
    ImFontConfig config;
    config.SizePixels = pixels;
    return atlas.AddFontDefault(&config);
}

/// Puts the icons into the font that was loaded last.
bool merge_icons(double size) {
    const std::string path = font_file(awesome);
    if (path.empty()) return false;
    ImFontConfig config;
    config.MergeMode = true;
    config.GlyphMinAdvanceX = static_cast<float>(size);
    config.GlyphOffset.y = static_cast<float>(0.06 * size);
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    return atlas.AddFontFromFileTTF(path.c_str(), static_cast<float>(size), &config, icons)
           != nullptr;
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
    case Icon::redo:
        return {"\xEF\x80\x9E", "redo"};
    case Icon::save:
        return {"\xEF\x83\x87", "save"};
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
    case Icon::edit:
        return {"\xEF\x81\x84", "edit"};
    case Icon::what_if:
        return {"\xEF\x83\x83", "if"};
    case Icon::flip:
        return {"\xEF\x83\xAC", "<>"};
    case Icon::tool:
        return {"\xEF\x82\xAD", "T"};
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

void tip(const Frame& frame, const std::string& words) {
    if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled) || words.empty()) return;
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(frame.px(10), frame.px(7)));
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(frame.px(320));
    ImGui::TextUnformatted(words.c_str());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
    ImGui::PopStyleVar();
}

bool icon_button(Frame& frame, Icon icon, Command command, bool is_on) {
    const float side = frame.px(32);
    ImGui::PushID(static_cast<int>(command));
    if (is_on) ImGui::PushStyleColor(ImGuiCol_Button, frame.palette.color(Role::accent, 0.42));
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(0, 0));
    const bool pressed = ImGui::Button(frame.fonts.icon(icon), ImVec2(side, side));
    ImGui::PopStyleVar();
    if (is_on) ImGui::PopStyleColor();
    tip(frame, tip_of(command));
    ImGui::PopID();
    if (pressed) frame.perform(command);
    return pressed;
}

bool word_button(Frame& frame, Icon icon, const char* word, bool icon_first, const char* words) {
    const std::string sign = frame.fonts.icon(icon);
    const std::string label = icon_first ? sign + "  " + word : std::string(word) + "  " + sign;
    const bool pressed = ImGui::Button(label.c_str(), ImVec2(0, frame.px(32)));
    tip(frame, words);
    return pressed;
}

std::string shortened(ImFont* font, const std::string& words, float width) {
    const auto length = [&](const std::string& part) {
        return font->CalcTextSizeA(font->FontSize, 1e9F, 0.0F, part.c_str()).x;
    };
    if (length(words) <= width) return words;
    size_t low = 0, high = words.size();
    while (low < high) {
        const size_t middle = (low + high + 1) / 2;
        if (length(words.substr(0, middle) + "\xE2\x80\xA6") <= width)
            low = middle;
        else
            high = middle - 1;
    }
    // Do not cut inside a UTF-8 sequence.
    while (low > 0 && (static_cast<unsigned char>(words[low]) & 0xC0) == 0x80) --low;
    return words.substr(0, low) + "\xE2\x80\xA6";
}

void value_row(Frame& frame, const char* name, const std::string& value, double name_width,
               bool is_changed) {
    const float left = ImGui::GetCursorPosX();
    text(frame.fonts.text, frame.palette.color(Role::dim), name);
    ImGui::SameLine();
    ImGui::SetCursorPosX(left + frame.px(name_width));
    const float width = ImGui::GetContentRegionAvail().x;
    const ImU32 color = frame.palette.color(is_changed ? Role::accent : Role::text);
    text(frame.fonts.mono, color, shortened(frame.fonts.mono, value, width));
    if (frame.fonts.mono->CalcTextSizeA(frame.fonts.mono->FontSize, 1e9F, 0.0F, value.c_str()).x
        > width)
        tip(frame, value);
}

void heading(Frame& frame, const char* words) {
    ImGui::Dummy(ImVec2(0, frame.px(1)));
    ImGui::Separator();
    ImGui::Dummy(ImVec2(0, frame.px(1)));
    text(frame.fonts.strong, frame.palette.color(Role::text), words);
}

void text(ImFont* font, ImU32 color, const std::string& words) {
    ImGui::PushFont(font);
    ImGui::PushStyleColor(ImGuiCol_Text, color);
    ImGui::TextUnformatted(words.c_str(), words.c_str() + words.size());
    ImGui::PopStyleColor();
    ImGui::PopFont();
}

namespace {

/// Words with line breaks in place of spaces, so that lines are not wider than `width` where that
/// is possible. ImGui also breaks lines after the points and commas in numbers.
std::string broken_at_spaces(const ImFont& font, std::string words, float width) {
    size_t line = 0, space = std::string::npos;
    for (size_t i = 0; i <= words.size(); ++i) {
        const bool is_end = i == words.size() || words[i] == '\n';
        if (!is_end && words[i] != ' ') continue;
        const float reach =
            font.CalcTextSizeA(font.FontSize, 1e9F, 0.0F, &words[line], &words[line] + (i - line))
                .x;
        if (reach > width && space != std::string::npos) {
            words[space] = '\n';
            line = space + 1;
        }
        space = is_end ? std::string::npos : i;
        if (is_end) line = i + 1;
    }
    return words;
}

} // namespace

void wrapped_text(ImFont* font, ImU32 color, const std::string& words) {
    ImGui::PushTextWrapPos(0.0F); // for words that are wider than the panel
    text(font, color, broken_at_spaces(*font, words, ImGui::GetContentRegionAvail().x));
    ImGui::PopTextWrapPos();
}

void draw_pill(const Frame& frame, ImDrawList& list, ImVec2 corner, const std::string& words) {
    ImFont* const font = frame.fonts.text;
    const ImVec2 size = font->CalcTextSizeA(font->FontSize, 1e9F, 0.0F, words.c_str());
    const float x = frame.px(11), y = frame.px(6);
    list.AddRectFilled(corner, {corner.x + size.x + 2 * x, corner.y + size.y + 2 * y},
                       frame.palette.color(render::Role::panel, 0.86), frame.px(5));
    list.AddText(font, font->FontSize, {corner.x + x, corner.y + y},
                 frame.palette.color(render::Role::text), words.c_str());
}

std::string clock_text(double seconds) {
    constexpr double longest = 3.6e9; // a million hours
    if (!(seconds < longest)) return "> 1,000,000 h";
    const auto whole = static_cast<long long>(std::max(std::floor(seconds), 0.0));
    return fmt::format("{:02}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

} // namespace app::viewer
