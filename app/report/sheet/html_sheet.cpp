#include "app/report/sheet/html_sheet.h"

#include <filesystem>

#include <fmt/format.h>

#include "app/base/version.h"
#include "app/check/check_run.h"
#include "app/check/prepared_check.h"
#include "app/report/html/html_facts.h"
#include "app/report/html/html_page.h"
#include "app/report/html/html_text.h"
#include "app/report/text/text_report.h"
#include "app/tolerance/tolerances.h"
#include "gcode/language/control.h"
#include "gcode/language/dialect.h"

namespace app {

SheetContent sheet_content(const PreparedCheck& check, const std::string& setup_text) {
    const SetupFile& file = check.file;
    const gcode::Dialect& dialect = gcode::dialect(check.run.dialect);
    SheetContent content;
    content.sheet = sheet_of(file, check.run.setup);
    content.use = program_use(check);
    content.stated = stated_in(setup_text);
    content.stated_lengths = file.lengths_set;
    content.control = file.control.preset ? file.control.preset->name : dialect.name;
    content.calls_zero_datum = dialect.language == gcode::Language::klartext;
    content.touches_off = file.touches_off;
    content.unit.inch = check.is_in_inches();
    return content;
}

namespace {

std::string last_part(const std::string& path) {
    const std::string name = std::filesystem::path(path).filename().generic_string();
    return name.empty() ? path : name;
}

std::string fact(const std::string& name, const std::string& value) {
    return value.empty() ? std::string() : fact_row(name, html_text(value));
}

/// Why the sheet is no release; empty if the check is clear and covers everything.
std::string release_html(const CheckRun& run) {
    if (std::string_view(verdict_class(run)) == "clear") return {};
    return "<p class=\"release\" role=\"note\">This sheet does not release the program: see the "
           "verdict above and the report of the check.</p>\n";
}

std::string machine_text(const CheckRun& run, const SheetContent& content) {
    if (!content.stated.machine_file.empty()) return last_part(content.stated.machine_file);
    if (!content.stated.machine_preset.empty())
        return fmt::format("preset {}", content.stated.machine_preset);
    if (content.sheet.has_machine) return "axes as in the set-up";
    return run.setup.machine.bodies.empty() ? "not described" : "bodies as in the set-up";
}

std::string tolerance_fact(const CheckRun& run, const SheetContent& content) {
    if (!run.tolerances) return "not studied: run feeler sheet with --tolerances";
    if (!run.tolerances->refusal.empty()) return "none: " + run.tolerances->refusal;
    return std::string("each value alone may be off by what its line says, and the check is proven "
                       "to stay clear; a value without a line ")
           + (content.tolerances_were_stopped ? "was not studied, because the search was stopped"
                                              : "has no effect on the check");
}

/// The file of the set-up, and the begin of the SHA-256 of its text.
std::string setup_text(const SheetContent& content) {
    constexpr size_t digits = 16;
    const std::string& path = content.sheet.path;
    std::string text = path.empty() ? "inferred from the program" : last_part(path);
    if (content.has_unsaved_edits)
        text = path.empty() ? "not saved yet" : text + " with edits that are not saved";
    if (content.setup_sha256.empty()) return text;
    return text + ", SHA-256 " + content.setup_sha256.substr(0, digits) + " \xE2\x80\xA6";
}

std::string facts_html(const CheckRun& run, const SheetContent& content) {
    std::string rows;
    if (run.stopped) rows += fact("Stopped", error_text(*run.stopped));
    rows += fact("Program", fmt::format("{}{}{}", last_part(run.program_file),
                                        content.program_date.empty() ? "" : ", written ",
                                        content.program_date));
    rows += fact("SHA-256", run.sha256);
    rows += fact("Set-up", setup_text(content));
    rows += fact("Machine", machine_text(run, content));
    rows += fact("Check",
                 fmt::format("{}{}Feeler {}: {}", content.check_date,
                             content.check_date.empty() ? "" : ", ", version, counts_text(run)));
    return rows + fact("How wrong", tolerance_fact(run, content));
}

std::string picture_html(const SheetPicture& picture, const std::string& caption) {
    std::string html = fmt::format("<figure><img alt=\"{0}\" src=\"data:image/jpeg;base64,{1}\">"
                                   "<figcaption>{0}</figcaption>",
                                   html_text(caption), base64(picture.jpeg));
    for (const SheetPicture::Label& label : picture.labels)
        html += fmt::format("<span{} style=\"left:{:.1f}%;top:{:.1f}%\">{}</span>",
                            label.is_axis ? " class=\"axis\"" : "", 100.0 * label.x,
                            100.0 * label.y, html_text(label.words));
    return html + "</figure>\n";
}

std::string pictures_html(const SheetPictures& pictures) {
    if (!pictures.missing.empty())
        return "<p>There are no pictures: " + html_text(pictures.missing) + "</p>\n";
    if (pictures.iso.jpeg.empty()) return {};
    return "<div class=\"pictures\">\n" + picture_html(pictures.iso, "At the start of the program")
           + picture_html(pictures.top, "From above") + "</div>\n";
}

std::string legend_html(const SheetContent& content) {
    std::string text = fmt::format(
        "<p>Lengths in {}. Left is towards smaller X, front towards smaller Y.</p>\n"
        "<p>\xE2\x97\x8B assumed: neither the set-up nor the program states it. Measure or confirm "
        "it before the start.</p>\n",
        content.unit.inch ? "inches" : "mm");
    if (content.touches_off)
        text += "<p>Assumed: Z is touched off on the work with each tool.</p>\n";
    return text;
}

} // namespace

std::string html_sheet(const CheckRun& run, const SheetContent& content) {
    const SheetAssets assets = sheet_assets();
    const size_t items = content.use.tools.size() + run.setup.fixtures.size();
    const size_t rows = run.tolerances ? 2 * items : items;
    return filled_page(assets.page, {{"version", version},
                                     {"name", html_text(last_part(run.program_file))},
                                     {"palette", html_palette()},
                                     {"style", std::string(assets.style)},
                                     {"size", rows > 24   ? "most"
                                              : rows > 14 ? "many"
                                                          : "few"},
                                     {"control", html_text(content.control)},
                                     {"verdict", verdict_class(run)},
                                     {"outcome", html_text(run.headline())},
                                     {"release", release_html(run)},
                                     {"uncovered", uncovered_html(run)},
                                     {"facts", facts_html(run, content)},
                                     {"pictures", pictures_html(content.pictures)},
                                     {"tables", sheet_tables(run, content)},
                                     {"legend", legend_html(content)}});
}

} // namespace app
