#include "app/report/batch_text.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "app/report/text_layout.h"

namespace app {
namespace {

using core::Severity;

/// What one word says of a program, and the colour of that word.
struct Outcome {
    std::string word;
    int colour; // of ANSI terminals
};

constexpr int red = 31, green = 32, yellow = 33;

Outcome outcome_of(const ProgramResult& result) {
    if (result.error) return {result.blocks == 0 ? "not run" : "stopped", red};
    if (status_of(result) == 0 && result.verdict == core::Verdict::clear) return {"clear", green};
    if (result.verdict == core::Verdict::clear) return {"errors", red};
    const bool is_hit = result.verdict == core::Verdict::collision;
    return {core::name_of(result.verdict), is_hit ? red : yellow};
}

std::string coloured(const std::string& text, int colour, const BatchStyle& style) {
    return style.colour ? fmt::format("\033[{}m{}\033[0m", colour, text) : text;
}

std::string counts_text(const ProgramResult& result) {
    std::string text;
    for (const Severity severity : {Severity::error, Severity::warning, Severity::note})
        if (const size_t count = count_of(result, severity))
            text += (text.empty() ? "" : ", ") + counted(count, core::name_of(severity));
    return text;
}

/// A line for each rule that was found, with its lines in the program; the worst first.
std::string findings_text(const ProgramResult& result, const BatchStyle& style) {
    struct Group {
        const KeptFinding* first;
        std::vector<uint32_t> lines;
    };
    std::map<std::pair<int, std::string>, Group> groups;
    for (const KeptFinding& finding : result.findings) {
        if (finding.severity != Severity::error && !style.verbose) continue;
        const std::pair<int, std::string> key = {-static_cast<int>(finding.severity),
                                                 finding.rule + finding.file};
        Group& group = groups.try_emplace(key, Group{&finding, {}}).first->second;
        if (finding.line != 0) group.lines.push_back(finding.line);
    }
    std::string text;
    for (const auto& [key, group] : groups) {
        const KeptFinding& first = *group.first;
        std::string line = fmt::format("{} {}", core::name_of(first.severity), first.rule);
        if (!first.file.empty()) line += " in " + first.file;
        if (!group.lines.empty())
            line += fmt::format(", line{} {}", group.lines.size() == 1 ? "" : "s",
                                line_ranges(group.lines));
        text += wrapped(line + ": " + first.message, 11, 2);
    }
    return text;
}

std::string place_of(const KeptError& error, const std::string& program) {
    std::string place = error.file.empty() ? program : error.file;
    if (error.line != 0) place += fmt::format(":{}", error.line);
    if (error.line != 0 && error.column != 0) place += fmt::format(":{}", error.column);
    return trimmed(place);
}

std::string error_line(const ProgramResult& result) {
    return place_of(*result.error, result.program) + ": " + result.error->message;
}

/// The same below the line of the program, which need not be named again.
std::string own_error_line(const ProgramResult& result) {
    const KeptError& error = *result.error;
    const bool is_own = error.file.empty() || error.file == result.program;
    if (!is_own) return error_line(result);
    return error.line == 0 ? error.message : fmt::format("line {}: {}", error.line, error.message);
}

std::string verdicts_text(const BatchResult& batch) {
    std::map<std::string, size_t> counts;
    for (const ProgramResult& program : batch.programs) ++counts[outcome_of(program).word];
    std::string text;
    for (const char* word :
         {"clear", "collision", "violation", "undecided", "errors", "stopped", "not run"})
        if (counts[word] > 0)
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", counts[word], word);
    if (!batch.unchecked.empty())
        text += fmt::format("{}{} not checked", text.empty() ? "" : ", ", batch.unchecked.size());
    return text;
}

std::string rules_text(const BatchResult& batch) {
    struct Tally {
        size_t programs = 0, findings = 0;
    };
    std::map<std::pair<int, std::string>, Tally> tallies; // errors first
    for (const ProgramResult& program : batch.programs) {
        std::map<std::pair<int, std::string>, size_t> here;
        for (const KeptFinding& finding : program.findings)
            ++here[{-static_cast<int>(finding.severity), finding.rule}];
        for (const auto& [rule, count] : here) {
            ++tallies[rule].programs;
            tallies[rule].findings += count;
        }
    }
    std::string text;
    for (const auto& [rule, tally] : tallies)
        text += fmt::format("  {:<8} {:<26} {:>7} in {}\n",
                            core::name_of(static_cast<Severity>(-rule.first)), rule.second,
                            tally.findings, counted(tally.programs, "program"));
    return text;
}

std::string slowest_text(const BatchResult& batch) {
    constexpr size_t shown = 3;
    std::vector<const ProgramResult*> slowest;
    for (const ProgramResult& program : batch.programs) slowest.push_back(&program);
    const size_t count = std::min(shown, slowest.size());
    std::partial_sort(slowest.begin(), slowest.begin() + static_cast<std::ptrdiff_t>(count),
                      slowest.end(),
                      [](const auto* a, const auto* b) { return a->seconds > b->seconds; });
    std::string text;
    for (size_t i = 0; i < count; ++i)
        text += fmt::format("  slowest  {:>7.2f} s  {}\n", slowest[i]->seconds,
                            trimmed(slowest[i]->program));
    return text;
}

/// The first lines of a list, or all of them.
std::string list_text(const std::vector<std::string>& lines, const BatchStyle& style) {
    constexpr size_t shown = 10;
    const size_t most = style.verbose ? lines.size() : std::min(lines.size(), shown);
    std::string text;
    for (size_t i = 0; i < most; ++i) text += wrapped(lines[i], 2, 2);
    if (most < lines.size())
        text += fmt::format("  ... and {} more (--verbose names them)\n", lines.size() - most);
    return text;
}

/// Programs that were not run to their end, and why; those that were not checked; what was skipped.
std::string missing_text(const BatchResult& batch, const BatchStyle& style) {
    std::vector<std::string> stopped, unchecked, skipped;
    for (const ProgramResult& program : batch.programs)
        if (program.error) stopped.push_back("not run to its end: " + error_line(program));
    for (const std::string& program : batch.unchecked)
        unchecked.push_back("not checked: " + trimmed(program));
    for (const SkippedFile& file : batch.skipped)
        skipped.push_back(fmt::format("skipped: {} {}", trimmed(file.path), file.why));
    return list_text(stopped, style) + list_text(unchecked, style)
           + (style.quiet ? std::string() : list_text(skipped, style));
}

} // namespace

std::string program_text(const ProgramResult& result, const BatchStyle& style) {
    if (style.quiet && status_of(result) == 0) return {};
    const Outcome outcome = outcome_of(result);
    std::string text = coloured(fmt::format("{:<10}", outcome.word), outcome.colour, style) + " "
                       + trimmed(result.program);
    const std::string counts = counts_text(result);
    if (!counts.empty()) text += ": " + counts;
    text += "\n";
    if (result.error) text += wrapped(own_error_line(result), 11, 2);
    text += findings_text(result, style);
    for (size_t i = 0; style.verbose && i < result.assumptions.size(); ++i)
        text += wrapped("assumed: " + result.assumptions[i], 11, 2);
    return text;
}

std::string batch_summary(const BatchResult& batch, double seconds, const BatchStyle& style) {
    std::string text = counted(batch.programs.size() + batch.unchecked.size(), "program");
    if (seconds >= 60.0) text += " in " + duration_text(seconds);
    if (seconds >= 0.0 && seconds < 60.0) text += fmt::format(" in {:.1f} s", seconds);
    const std::string verdicts = verdicts_text(batch);
    text += (verdicts.empty() ? verdicts : ": " + verdicts) + "\n" + rules_text(batch);
    if (seconds >= 0.0) text += slowest_text(batch);
    return text + missing_text(batch, style);
}

std::string batch_text(const BatchResult& batch, const BatchStyle& style) {
    std::string text;
    for (const ProgramResult& program : batch.programs) text += program_text(program, style);
    return text + "\n" + batch_summary(batch, -1.0, style);
}

} // namespace app
