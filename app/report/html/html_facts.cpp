#include "app/report/html/html_facts.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/base/clearance_text.h"
#include "app/base/text.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/conclusion.h"
#include "app/report/html/html_text.h"
#include "app/report/text/text_report.h"
#include "app/setup/coverage.h"
#include "app/tolerance/tolerances.h"
#include "core/motion/path.h"
#include "core/motion/timing.h"
#include "core/sim/part_comparison.h"
#include "core/sim/verdict.h"
#include "gcode/language/dialect.h"

namespace app {
namespace {

std::string row(const std::string& name, const std::string& value) {
    return fact_row(name, html_text(value));
}

std::string term(const std::string& name, const std::string& size, const std::string& about) {
    return fmt::format(
        "<tr><th scope=\"row\">{}</th><td class=\"number\">{}</td><td>{}</td></tr>\n",
        html_text(name), html_text(size), html_text(about));
}

std::string tightest_text(const CheckRun& run) {
    const auto block = tightest_block(run);
    if (!block) return "no pair of bodies within the search limit";
    const core::PairClearance& pair = block->result.pairs[*block->result.deciding];
    return fmt::format("{}: {} / {} in block {}, line {}",
                       tightest_words(block->result, ClearanceStyle::sentence),
                       core::part_name(run.setup, pair.pair), core::body_name(run.setup, pair.pair),
                       core::value_of(block->block), block->line);
}

/// The widest interval between bounds of a deciding pair in any block, mm; empty if none was
/// measured.
std::optional<double> widest_interval(const CheckRun& run) {
    std::optional<double> widest;
    for (const CheckedBlock& block : run.blocks.without_texts()) {
        if (!block.result.deciding) continue;
        const core::PairClearance& pair = block.result.pairs[*block.result.deciding];
        if (pair.found()) widest = std::max(widest.value_or(0.0), pair.upper - pair.lower);
    }
    return widest;
}

} // namespace

const char* verdict_class(const CheckRun& run) {
    if (run.verdict != core::Verdict::clear) return core::name_of(run.verdict);
    if (run.stopped || run.has_errors()) return "error";
    const Coverage coverage = run.full_coverage();
    return coverage.is_complete() && coverage.moves ? "clear" : "partly";
}

std::string uncovered_html(const CheckRun& run) {
    const std::string uncovered = uncovered_text(run.full_coverage());
    if (uncovered.empty()) return {};
    return "<p class=\"uncovered\" role=\"note\"><b>Not checked:</b> " + html_text(uncovered)
           + "</p>\n";
}

std::string fact_row(const std::string& name, const std::string& html) {
    return fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", html_text(name), html);
}

std::string html_summary(const CheckRun& run) {
    const auto moving =
        std::count_if(run.blocks.begin(), run.blocks.end(), [](const CheckedBlock& block) {
            return block.result.motion != core::BlockMotion::none;
        });
    std::string rows;
    if (run.stopped) rows += row("stopped", error_text(*run.stopped));
    rows += row("findings", counts_text(run)) + row("tightest", tightest_text(run));
    rows += row("blocks", fmt::format("{}, {} with motion", run.blocks.size(), moving));
    rows += row("cycle time", duration_text(run.cycle_time));
    rows += row("removed", fmt::format("{:.1f} mm\xC2\xB3", run.removed));
    rows +=
        row("minimum clearance", run.setup.allowance ? fmt::format("{} mm", *run.setup.allowance)
                                                     : "the default of each pair of bodies");
    rows += row("dialect", std::string(gcode::dialect(run.dialect).name));
    rows += row("engine", name_of(run.engine));
    if (run.comparison) rows += row("part", facts_of(*run.comparison, *run.setup.part));
    rows += row("model", fmt::format("{} scan lines, {} points, {:.0f} MB; checked in {:.2f} s",
                                     run.lines, run.points, std::ceil(1e-6 * run.memory),
                                     run.times.read + run.times.model + run.times.check));
    return rows + row("SHA-256 of the program", run.sha256);
}

std::string html_bound_terms(const CheckRun& run) {
    const double h = run.setup.mesh_size;
    std::string rows =
        term("cell", fmt::format("{} mm", h),
             fmt::format("Spacing of the scan lines of the stock. The lower bound counts all "
                         "material that may lie between them; {} cells were recomputed at a finer "
                         "mesh size to decide a verdict.",
                         run.statistics.refined));
    rows += term("chord", core::at_most(core::chord_error(h), 4) + " mm",
                 "Arcs are cut and checked as chords within this of them.");
    rows +=
        term("path tolerance", fmt::format("{} mm", core::default_blend_tolerance),
             "For times only: corners are rounded by this unless the program states a path mode.");
    rows += term("stock tolerance", fmt::format("{} mm", run.setup.stock.tolerance),
                 "The raw stock may be larger by this on every side, as the set-up states.");
    rows += term("resolution", fmt::format("{:g} mm", core::resolution),
                 "Clearances are compared with their minimum to within this.");
    rows += term("search limit", fmt::format("{} mm", run.setup.search_limit),
                 "Clearances beyond this are not measured.");
    if (const auto widest = widest_interval(run))
        rows +=
            term("widest interval", core::at_most(*widest) + " mm",
                 "Largest difference between the lower and upper bound of a deciding pair in any "
                 "block.");
    return rows;
}

std::string html_tolerances(const CheckRun& run) {
    if (!run.tolerances) return {};
    const Tolerances& tolerances = *run.tolerances;
    std::string section = "<section id=\"tolerances\" aria-labelledby=\"tolerances-title\">\n"
                          "<h2 id=\"tolerances-title\">Tolerances of the set-up</h2>\n";
    if (!tolerances.refusal.empty())
        return section + "<p>There are none: " + html_text(tolerances.refusal)
               + ".</p>\n</section>\n";
    section +=
        "<p>How far each value of the set-up may deviate, one at a time: the check is proven "
        "to stay clear.</p>\n<div class=\"wide\"><table class=\"terms\"><thead><tr>"
        "<th scope=\"col\">Value</th><th scope=\"col\">Tolerance</th><th scope=\"col\">"
        "Limited downwards by</th><th scope=\"col\">Limited upwards by</th></tr></thead>"
        "<tbody>\n";
    for (const Tolerance& tolerance : tolerances.list)
        section += fmt::format(
            "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td></tr>\n",
            html_text(title_of(tolerance.deviation)), html_text(range_text(tolerance)),
            html_text(limit_text(tolerance.less)), html_text(limit_text(tolerance.more)));
    return section + "</tbody></table></div>\n</section>\n";
}

} // namespace app
