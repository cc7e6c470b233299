#include "app/report/html_batch_facts.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "app/batch/outcome.h"
#include "app/report/html_bounds.h"
#include "app/report/html_columns.h"
#include "app/report/html_facts.h"
#include "app/report/html_text.h"
#include "app/report/rule_help.h"
#include "app/report/rule_tally.h"
#include "app/report/skipped_group.h"
#include "app/report/text_layout.h"
#include "core/sim/bound_text.h"

namespace app {
namespace {

using core::Severity;

size_t all_programs(const BatchResult& batch) {
    return batch.programs.size() + batch.unchecked.size();
}

size_t programs_with(const BatchResult& batch, Outcome outcome) {
    if (outcome == Outcome::unchecked) return batch.unchecked.size();
    return static_cast<size_t>(
        std::count_if(batch.programs.begin(), batch.programs.end(),
                      [&](const ProgramResult& p) { return outcome_of(p) == outcome; }));
}

size_t programs_of_status(const BatchResult& batch, int status) {
    return static_cast<size_t>(
        std::count_if(batch.programs.begin(), batch.programs.end(),
                      [&](const ProgramResult& p) { return status_of(p) == status; }));
}

/// "3 of 125 programs".
std::string share(const BatchResult& batch, size_t count) {
    return fmt::format("{} of {}", count, counted(all_programs(batch), "program"));
}

/// The program with the least margin of all; the number of programs if none has one.
size_t tightest_program(const BatchResult& batch) {
    const auto margin = [](const ProgramResult& program) {
        return program.tightest->lower - program.tightest->allowance;
    };
    size_t tightest = batch.programs.size();
    for (size_t i = 0; i < batch.programs.size(); ++i) {
        if (!batch.programs[i].tightest) continue;
        const bool is_first = tightest == batch.programs.size();
        if (is_first || margin(batch.programs[i]) < margin(batch.programs[tightest])) tightest = i;
    }
    return tightest;
}

std::string tightest_html(const BatchResult& batch) {
    const size_t at = tightest_program(batch);
    if (at == batch.programs.size()) return "no pair of bodies came near in any program";
    const ProgramResult& program = batch.programs[at];
    const Tightest& tightest = *program.tightest;
    const std::string name = program.program.substr(common_folder(batch).size());
    const double margin =
        1e-3 * static_cast<double>(clearance_um(tightest.lower) - um_above(tightest.allowance));
    return fmt::format("{}{:.3f} mm: clearance {}, {} mm to keep, {} / {}, <button type=\"button\" "
                       "class=\"link\" data-program=\"{}\">{}, line {}</button>",
                       tightest.upper ? "" : "\xE2\x89\xA5 ", margin,
                       bounds_text(tightest.lower, tightest.upper, tightest.allowance),
                       core::at_most(tightest.allowance), html_text(tightest.pair[0]),
                       html_text(tightest.pair[1]), at, html_text(name), tightest.line);
}

std::string findings_text(const BatchResult& batch) {
    std::string text;
    for (const Severity severity : {Severity::error, Severity::warning, Severity::note}) {
        size_t count = 0;
        for (const ProgramResult& program : batch.programs) count += count_of(program, severity);
        text += (text.empty() ? "" : ", ") + counted(count, core::name_of(severity));
    }
    return text;
}

template <typename Field>
double sum_of(const BatchResult& batch, Field field) {
    return std::accumulate(
        batch.programs.begin(), batch.programs.end(), 0.0,
        [&](double sum, const ProgramResult& program) { return sum + program.*field; });
}

std::string status_text(const BatchResult& batch) {
    const char* const meanings[] = {"0: no program has an error", "1: there are errors",
                                    "2: not every program could be checked to its end"};
    return meanings[status_of(batch)];
}

/// The names of the first ones, and how many more there are.
std::string list_html(const std::vector<std::string>& names, size_t most) {
    std::string list = "<ul>\n";
    for (size_t i = 0; i < std::min(most, names.size()); ++i)
        list += "<li>" + html_text(names[i]) + "</li>\n";
    if (names.size() > most) list += fmt::format("<li>and {} more</li>\n", names.size() - most);
    return list + "</ul>\n";
}

} // namespace

std::string common_folder(const BatchResult& batch) {
    std::optional<std::string> folder;
    const auto narrow = [&](const std::string& path) {
        if (!folder) folder = path.substr(0, path.rfind('/') + 1);
        while (!path.starts_with(*folder)) {
            folder->pop_back();
            folder->resize(folder->rfind('/') + 1);
        }
    };
    for (const ProgramResult& program : batch.programs) narrow(program.program);
    for (const std::string& program : batch.unchecked) narrow(program);
    return folder.value_or("");
}

std::string batch_title(const BatchResult& batch) {
    const std::string folder = common_folder(batch);
    const std::string all =
        counted(all_programs(batch), "program") + (folder.empty() ? folder : " in " + folder);
    return batch.share.empty() ? all : all + ", " + batch.share;
}

std::string batch_outcome_text(const BatchResult& batch) {
    if (all_programs(batch) == 0) return "no program was checked";
    const size_t lost = programs_of_status(batch, 2) + batch.unchecked.size();
    if (lost > 0) return share(batch, lost) + " not checked to the end";
    const size_t bad = programs_of_status(batch, 1);
    if (bad > 0) return share(batch, bad) + (bad == 1 ? " has errors" : " have errors");
    const size_t clear = programs_with(batch, Outcome::clear);
    if (clear == all_programs(batch)) return counted(clear, "program") + ": all clear";
    return share(batch, clear) + " clear, no errors";
}

const char* batch_outcome_class(const BatchResult& batch) {
    if (status_of(batch) > 0) return "error";
    if (all_programs(batch) == 0) return "undecided";
    return programs_with(batch, Outcome::clear) == all_programs(batch) ? "clear" : "undecided";
}

std::string html_missing(const BatchResult& batch) {
    constexpr size_t shown = 5, longest = 160;
    const std::string folder = common_folder(batch);
    std::vector<std::string> unchecked, stopped;
    for (const std::string& program : batch.unchecked)
        unchecked.push_back(program.substr(folder.size()));
    for (const ProgramResult& program : batch.programs)
        if (program.error)
            stopped.push_back(program.program.substr(folder.size()) + ": "
                              + clipped(program.error->message, longest));
    std::string html;
    if (!batch.share.empty())
        html += "<p><b>" + html_text(batch.share) + ":</b> of the others other reports tell.</p>\n";
    if (!unchecked.empty())
        html += "<p><b>" + share(batch, unchecked.size())
                + " not checked:</b> the batch was ended before.</p>\n"
                + list_html(unchecked, shown);
    if (!stopped.empty())
        html += "<p><b>" + share(batch, stopped.size())
                + " could not be run to the end:</b> nothing is said of what comes behind.</p>\n"
                + list_html(stopped, shown);
    if (html.empty()) return html;
    if (!unchecked.empty() || !stopped.empty())
        html += "<p><button type=\"button\" data-lost=\"true\">Show all of them</button></p>";
    return "<div class=\"missing\" role=\"note\">\n" + html + "</div>\n";
}

std::string html_outcomes(const BatchResult& batch) {
    std::string html;
    for (auto outcome = all_outcomes.rbegin(); outcome != all_outcomes.rend(); ++outcome)
        if (const size_t count = programs_with(batch, *outcome))
            html += fmt::format("<button type=\"button\" class=\"tile\" data-outcome=\"{}\" "
                                "style=\"flex-grow:{}\"><b>{}</b> {}</button>\n",
                                static_cast<int>(*outcome), count, count, name_of(*outcome));
    return html;
}

std::string html_batch_summary(const BatchResult& batch) {
    size_t blocks = 0;
    for (const ProgramResult& program : batch.programs) blocks += program.blocks;
    return fact_row("status", status_text(batch)) + fact_row("findings", findings_text(batch))
           + fact_row("least margin", tightest_html(batch))
           + fact_row("blocks", fmt::format("{}", blocks))
           + fact_row("cycle time of all", duration_text(sum_of(batch, &ProgramResult::cycle_time)))
           + fact_row(
               "checking took",
               duration_text(sum_of(batch, &ProgramResult::seconds))
                   + ", all programs together; those kept from an earlier check count as then");
}

std::string html_rules(const BatchResult& batch) {
    std::string rows;
    for (const RuleTally& tally : rule_tallies(batch))
        rows += fmt::format(
            "<tr><td><span class=\"badge {0}\">{0}</span></td><td><button type=\"button\" "
            "class=\"link\" data-rule=\"{1}\">{1}</button></td><td class=\"number\">{2}</td>"
            "<td class=\"number\">{3}</td><td>{4}</td></tr>\n",
            core::name_of(tally.severity), html_text(tally.rule), tally.findings, tally.programs,
            html_text(help_of(tally.rule).finds));
    return rows;
}

std::string html_skipped(const BatchResult& batch) {
    constexpr size_t shown = 200;
    std::string html;
    for (const SkippedGroup& group : skipped_groups(batch.skipped))
        html += fmt::format("<details><summary>{}: {}</summary>\n",
                            counted(group.files.size(), "file"), html_text(group.why))
                + list_html(group.files, shown) + "</details>\n";
    return html.empty() ? "<p>None.</p>\n" : html;
}

} // namespace app
