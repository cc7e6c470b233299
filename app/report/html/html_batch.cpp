#include "app/report/html/html_batch.h"

#include <algorithm>
#include <iterator>
#include <numeric>

#include <fmt/format.h>

#include "app/base/clearance_text.h"
#include "app/base/text.h"
#include "app/base/version.h"
#include "app/library/result/batch_result.h"
#include "app/report/html/html_facts.h"
#include "app/report/html/html_page.h"
#include "app/report/html/html_text.h"
#include "app/report/text/batch_text.h"
#include "core/sim/finding.h"
#include "core/sim/verdict.h"

namespace app {
namespace {

std::string batch_names() {
    return script_names("outcomes", all_outcomes)
           + script_names("severities", core::all_severities);
}

} // namespace

std::string batch_html_report(const BatchResult& batch) {
    const PageAssets assets = batch_page_assets();
    return filled_page(assets.page, {{"version", version},
                                     {"name", html_text(batch_title(batch))},
                                     {"outcome", batch_outcome_text(batch)},
                                     {"verdict", batch_outcome_class(batch)},
                                     {"palette", html_palette()},
                                     {"style", std::string(assets.style)},
                                     {"missing", html_missing(batch)},
                                     {"outcomes", html_outcomes(batch)},
                                     {"summary", html_batch_summary(batch)},
                                     {"rules", html_rules(batch)},
                                     {"skipped", html_skipped(batch)},
                                     {"programs", batch_columns_json(batch)},
                                     {"script", batch_names() + std::string(assets.script)}});
}

namespace {

/// The programs of a batch as columns, with shared tables of texts and findings.
class ProgramColumns {
public:
    explicit ProgramColumns(size_t most_findings) : findings_(texts_, most_findings) {}

    void add(const ProgramResult& program, Outcome outcome);
    std::string json(const std::string& folder) const;

private:
    void add_tightest(const std::optional<Tightest>& tightest);
    void add_error(const StoredError& error);

    TextTable texts_;
    FindingColumns findings_;
    std::vector<std::string> paths_, digests_;
    NumberRuns outcome_, setup_, dialect_, engine_, pair_, assumptions_;
    std::vector<int64_t> blocks_, cycle_, removed_, seconds_, line_, block_, lower_, width_, keep_,
        assumed_;
    std::string errors_; // "[program,file,line,column,message],..."
};

void ProgramColumns::add_tightest(const std::optional<Tightest>& tightest) {
    const int64_t lower = tightest ? clearance_um(tightest->lower) : -1;
    const bool has_upper = tightest && tightest->upper;
    pair_.add(tightest ? shown_text(texts_, pair_name(tightest->pair)) : -1);
    line_.push_back(tightest ? tightest->line : 0);
    block_.push_back(tightest ? tightest->block : 0);
    lower_.push_back(lower);
    width_.push_back(has_upper ? std::max<int64_t>(um_above(*tightest->upper) - lower, 0) : -1);
    keep_.push_back(tightest ? um_above(tightest->allowance) : 0);
}

void ProgramColumns::add_error(const StoredError& error) {
    fmt::format_to(std::back_inserter(errors_), "{}[{},{},{},{},{}]", errors_.empty() ? "" : ",",
                   paths_.size() - 1, shown_text(texts_, error.file), error.line, error.column,
                   shown_text(texts_, error.message));
}

void ProgramColumns::add(const ProgramResult& program, Outcome outcome) {
    paths_.push_back(program.program);
    digests_.push_back(program.sha256);
    outcome_.add(static_cast<int64_t>(outcome));
    setup_.add(shown_text(texts_, program.setup));
    dialect_.add(shown_text(texts_, program.dialect));
    engine_.add(shown_text(texts_, program.engine));
    blocks_.push_back(static_cast<int64_t>(program.blocks));
    cycle_.push_back(steps_of(program.cycle_time, 1e-3));
    removed_.push_back(steps_of(program.removed, 1.0));
    seconds_.push_back(steps_of(program.seconds, 1e-3));
    add_tightest(program.tightest);
    if (program.error) add_error(*program.error);
    const std::string uncovered = uncovered_text(program);
    assumptions_.add(
        static_cast<int64_t>(program.assumptions.size() + (uncovered.empty() ? 0 : 1)));
    if (!uncovered.empty()) assumed_.push_back(shown_text(texts_, "not checked: " + uncovered));
    for (const std::string& assumption : program.assumptions)
        assumed_.push_back(shown_text(texts_, assumption));
    findings_.add(program);
}

std::string ProgramColumns::json(const std::string& folder) const {
    std::string json =
        fmt::format(R"({{"count":{},"folder":{},"path":)", paths_.size(), script_string(folder));
    json += string_array(paths_) + R"(,"sha256":)" + string_array(digests_) + R"(,"outcome":)"
            + outcome_.json() + R"(,"setup":)" + setup_.json() + R"(,"dialect":)" + dialect_.json()
            + R"(,"engine":)" + engine_.json() + R"(,"blocks":)" + number_array(blocks_)
            + R"(,"cycle":)" + number_array(cycle_) + R"(,"removed":)" + number_array(removed_)
            + R"(,"seconds":)" + number_array(seconds_);
    json += R"(,"pair":)" + pair_.json() + R"(,"line":)" + number_array(line_) + R"(,"block":)"
            + number_array(block_) + R"(,"lower":)" + number_array(lower_) + R"(,"width":)"
            + number_array(width_) + R"(,"keep":)" + number_array(keep_) + R"(,"errors":[)"
            + errors_ + R"(],"assumptions":)" + assumptions_.json() + R"(,"assumed":)"
            + number_array(assumed_) + R"(,"texts":)" + texts_.json();
    return json + R"(,"findings":)" + findings_.json() + "}";
}

std::string columns_json(const BatchResult& batch, size_t most_findings) {
    ProgramColumns columns(most_findings);
    for (const ProgramResult& program : batch.programs) columns.add(program, outcome_of(program));
    for (const std::string& program : batch.unchecked)
        columns.add({.program = program}, Outcome::unchecked);
    return columns.json(common_folder(batch));
}

/// The number of findings kept if each program keeps at most `most`.
size_t finding_count(const BatchResult& batch, size_t most) {
    size_t count = 0;
    for (const ProgramResult& program : batch.programs)
        count += std::min(program.findings.size(), most);
    return count;
}

} // namespace

std::string batch_columns_json(const BatchResult& batch) {
    constexpr size_t most_bytes = 18'000'000, most_in_all = 200'000;
    size_t most = 1'000; // per program
    while (most > 1 && finding_count(batch, most) > most_in_all) most /= 2;
    std::string json = columns_json(batch, most);
    for (; most > 1 && json.size() > most_bytes; json = columns_json(batch, most)) most /= 2;
    return json;
}

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
std::string count_text(const BatchResult& batch, size_t count) {
    return fmt::format("{} of {}", count, counted(all_programs(batch), "program"));
}

/// The program with the least margin; the number of programs if none has a margin.
size_t tightest_program(const BatchResult& batch) {
    const auto margin = [](const ProgramResult& program) {
        return program.tightest->lower - program.tightest->allowance;
    };
    size_t tightest = batch.programs.size();
    for (size_t i = 0; i < batch.programs.size(); ++i) {
        if (!batch.programs[i].tightest || has_only_contact(batch.programs[i])) continue;
        const bool is_first = tightest == batch.programs.size();
        if (is_first || margin(batch.programs[i]) < margin(batch.programs[tightest])) tightest = i;
    }
    return tightest;
}

std::string tightest_html(const BatchResult& batch) {
    const size_t at = tightest_program(batch);
    if (at == batch.programs.size())
        return "no pair of bodies within the search limit in any program, except permitted contact";
    const ProgramResult& program = batch.programs[at];
    const Tightest& tightest = *program.tightest;
    const std::string name = program.program.substr(common_folder(batch).size());
    const double margin =
        1e-3 * static_cast<double>(clearance_um(tightest.lower) - um_above(tightest.allowance));
    return fmt::format(
        "{}{:.3f} mm: clearance {} (minimum {} mm), {} / {}, <button type=\"button\" "
        "class=\"link\" data-program=\"{}\">{}, line {}</button>",
        tightest.upper ? "" : "\xE2\x89\xA5 ", margin,
        clearance_text({true, tightest.lower, tightest.upper, tightest.allowance},
                       ClearanceStyle::sentence),
        core::at_most(tightest.allowance), html_text(tightest.pair[0]), html_text(tightest.pair[1]),
        at, html_text(name), tightest.line);
}

std::string finding_counts(const BatchResult& batch) {
    size_t errors = 0, warnings = 0, notes = 0;
    for (const ProgramResult& program : batch.programs) {
        errors += count_of(program, Severity::error);
        warnings += count_of(program, Severity::warning);
        notes += count_of(program, Severity::note);
    }
    return counts_text(errors, warnings, notes);
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

/// The first `most` names as a list, and the number of the others.
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
    return batch.shard.empty() ? all : all + ", " + batch.shard;
}

std::string batch_outcome_text(const BatchResult& batch) {
    if (all_programs(batch) == 0) return "no program was checked";
    const size_t lost = programs_of_status(batch, 2) + batch.unchecked.size();
    if (lost > 0) return count_text(batch, lost) + " not checked to the end";
    const size_t bad = programs_of_status(batch, 1);
    if (bad > 0) return count_text(batch, bad) + (bad == 1 ? " has errors" : " have errors");
    const size_t clear = programs_with(batch, Outcome::clear);
    if (clear == all_programs(batch)) return counted(clear, "program") + ": all clear";
    return count_text(batch, clear) + " clear, no errors in the others";
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
    if (!batch.shard.empty())
        html += "<p><b>" + html_text(batch.shard)
                + ":</b> the reports of the other shards contain the other programs.</p>\n";
    if (!unchecked.empty())
        html += "<p><b>" + count_text(batch, unchecked.size())
                + " not checked:</b> the batch was stopped before them.</p>\n"
                + list_html(unchecked, shown);
    if (!stopped.empty())
        html +=
            "<p><b>" + count_text(batch, stopped.size())
            + " could not be run to the end:</b> the blocks after the error were not checked.</p>\n"
            + list_html(stopped, shown);
    if (html.empty()) return html;
    if (!unchecked.empty() || !stopped.empty())
        html += "<p><button type=\"button\" data-lost=\"true\">Show all</button></p>";
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
    const std::string uncovered = uncovered_summary(batch);
    return (uncovered.empty() ? "" : fact_row("not checked", html_text(uncovered)))
           + fact_row("status", status_text(batch)) + fact_row("findings", finding_counts(batch))
           + fact_row("least margin", tightest_html(batch))
           + fact_row("blocks", fmt::format("{}", blocks))
           + fact_row("cycle time of all", duration_text(sum_of(batch, &ProgramResult::cycle_time)))
           + fact_row(
               "checking took",
               duration_text(sum_of(batch, &ProgramResult::seconds))
                   + ", summed over all programs; stored results count with their original time");
}

std::string html_rules(const BatchResult& batch) {
    std::string rows;
    for (const RuleTally& tally : rule_tallies(batch)) {
        const core::RuleEntry* rule = core::find_rule(tally.rule);
        rows += fmt::format(
            "<tr><td><span class=\"badge {0}\">{0}</span></td><td><button type=\"button\" "
            "class=\"link\" data-rule=\"{1}\">{1}</button></td><td class=\"number\">{2}</td>"
            "<td class=\"number\">{3}</td><td><b>{5}.</b> {4}</td></tr>\n",
            core::name_of(tally.severity), html_text(tally.rule), tally.findings, tally.programs,
            html_text(std::string(rule ? rule->meaning : "")),
            html_text(core::title_of_rule(tally.rule)));
    }
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

namespace {

/// The first `most` findings of a program, highest severity first.
std::vector<const StoredFinding*> worst_findings(const ProgramResult& program, size_t most) {
    std::vector<const StoredFinding*> findings;
    for (const StoredFinding& finding : program.findings) findings.push_back(&finding);
    std::stable_sort(findings.begin(), findings.end(),
                     [](const auto* a, const auto* b) { return a->severity > b->severity; });
    if (findings.size() > most) findings.resize(most);
    return findings;
}

} // namespace

std::string pair_name(const std::array<std::string, 2>& pair) {
    return pair[0].empty() ? std::string() : pair[0] + " / " + pair[1];
}

int64_t shown_text(TextTable& texts, const std::string& text) {
    constexpr size_t longest = 2'000; // bytes
    return texts.index_of(clipped(trimmed(text), longest));
}

void FindingColumns::add(const ProgramResult& program) {
    const auto worst = worst_findings(program, most_);
    for (const StoredFinding* finding : worst) add(*finding);
    count_.add(static_cast<int64_t>(worst.size()));
    const auto tallies = rule_tallies(program);
    kinds_.add(static_cast<int64_t>(tallies.size()));
    for (const RuleTally& tally : tallies) {
        tally_.push_back(rules_.index_of(tally.rule));
        tally_.push_back(static_cast<int64_t>(tally.severity));
        tally_.push_back(static_cast<int64_t>(tally.findings));
    }
}

void FindingColumns::add(const StoredFinding& finding) {
    severity_.add(static_cast<int64_t>(finding.severity));
    rule_.add(rules_.index_of(finding.rule));
    block_.add(finding.block ? int64_t{core::value_of(*finding.block)} : -1);
    line_.add(finding.line);
    file_.add(shown_text(texts_, finding.file));
    text_.add(shown_text(texts_, finding.text));
    message_.add(shown_text(texts_, finding.message));
    cure_.add(shown_text(texts_, finding.cure));
    pair_.add(shown_text(texts_, pair_name(finding.pair)));
    shortfall_.add(um_above(finding.shortfall));
}

std::string FindingColumns::json() const {
    return R"({"rules":)" + rules_.json() + R"(,"count":)" + count_.json() + R"(,"kinds":)"
           + kinds_.json() + R"(,"tally":)" + number_array(tally_) + R"(,"severity":)"
           + severity_.json() + R"(,"rule":)" + rule_.json() + R"(,"block":)" + block_.json()
           + R"(,"line":)" + line_.json() + R"(,"file":)" + file_.json() + R"(,"text":)"
           + text_.json() + R"(,"message":)" + message_.json() + R"(,"cure":)" + cure_.json()
           + R"(,"pair":)" + pair_.json() + R"(,"shortfall":)" + shortfall_.json() + "}";
}

} // namespace app
