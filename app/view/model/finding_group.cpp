#include "app/view/model/finding_group.h"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

#include "app/base/findings.h"
#include "app/base/text.h"
#include "app/setup/setup_text.h"
#include "app/setup/toml_file.h"

namespace app::viewer {
namespace {

/// Whether no block between two blocks moves.
bool follow_each_other(const std::vector<BlockRow>& rows, size_t before, size_t after) {
    for (size_t block = before + 1; block < after; ++block)
        if (moves(rows[block])) return false;
    return true;
}

bool is_of(const BlockRow& row, const core::Finding& finding) {
    return row.lower && row.part == finding.pair[0] && row.body == finding.pair[1];
}

void take_worst(FindingStretch& stretch, size_t block, const BlockRow& row,
                const core::Finding& finding) {
    core::Finding known;
    known.shortfall = stretch.shortfall;
    known.overlap = stretch.overlap;
    if (stretch.count > 0 && !core::is_worse(finding, known)) return;
    stretch.worst = block;
    stretch.shortfall = finding.shortfall;
    stretch.overlap = finding.overlap;
    stretch.clearance = is_of(row, finding) ? row.lower : std::nullopt;
    stretch.message = finding.message;
    stretch.cure = finding.cure;
}

/// Adds a finding to its group. Findings must come in the order of their blocks.
void add(FindingGroup& group, const std::vector<BlockRow>& rows, const core::Finding& finding) {
    group.severity = std::max(group.severity, finding.severity);
    if (!finding.block || core::value_of(*finding.block) >= rows.size()) {
        group.message = finding.message;
        group.cure = finding.cure;
        return;
    }
    const size_t block = core::value_of(*finding.block);
    const bool goes_on =
        !group.stretches.empty() && follow_each_other(rows, group.stretches.back().last, block);
    if (!goes_on) {
        FindingStretch fresh;
        fresh.first = fresh.last = fresh.worst = block;
        group.stretches.push_back(fresh);
    }
    FindingStretch& stretch = group.stretches.back();
    take_worst(stretch, block, rows[block], finding);
    if (stretch.count > 0 && stretch.last == block) return; // a second finding for the same block
    stretch.last = block;
    ++stretch.count;
    ++group.count;
}

/// What makes one stretch worse than another: the shortfall, then the depth of the overlap.
std::pair<double, double> badness(const FindingStretch& stretch) {
    return {stretch.shortfall, depth_of(stretch).value_or(0.0)};
}

FindingGroup group_of(const std::vector<BlockRow>& rows, const GroupOf<core::Finding>& alike) {
    FindingGroup group;
    group.rule = alike.worst->rule;
    group.pair = alike.worst->pair;
    std::vector<const core::Finding*> findings = alike.findings;
    std::stable_sort(findings.begin(), findings.end(),
                     [](const auto* a, const auto* b) { return a->block < b->block; });
    for (const core::Finding* finding : findings) add(group, rows, *finding);
    const auto worst =
        std::max_element(group.stretches.begin(), group.stretches.end(),
                         [](const auto& a, const auto& b) { return badness(a) < badness(b); });
    group.worst = static_cast<size_t>(worst - group.stretches.begin());
    return group;
}

/// The largest shortfall in the group, mm.
double shortfall_of(const FindingGroup& group) {
    return group.stretches.empty() ? 0.0 : group.stretches[group.worst].shortfall;
}

size_t first_of(const FindingGroup& group) {
    return group.stretches.empty() ? 0 : group.stretches.front().first;
}

/// Findings with equal keys are one group: those of a rule about a pair of bodies. Of findings
/// about the program as a whole, such as gouges, each message is a group.
std::tuple<std::string, std::string, std::string, std::string>
group_key(const core::Finding& finding) {
    return {finding.rule, finding.pair[0], finding.pair[1],
            finding.block ? std::string() : finding.message};
}

} // namespace

std::vector<FindingGroup> grouped(const std::vector<BlockRow>& rows,
                                  const std::vector<core::Finding>& findings) {
    std::vector<FindingGroup> groups;
    for (const GroupOf<core::Finding>& alike : grouped_by(findings, group_key))
        groups.push_back(group_of(rows, alike));
    std::stable_sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) {
        if (a.severity != b.severity) return a.severity > b.severity;
        if (shortfall_of(a) != shortfall_of(b)) return shortfall_of(a) > shortfall_of(b);
        if (first_of(a) != first_of(b)) return first_of(a) < first_of(b);
        return std::tie(a.rule, a.pair) < std::tie(b.rule, b.pair);
    });
    return groups;
}

std::optional<double> depth_of(const FindingStretch& stretch) {
    if (!stretch.overlap) return {};
    return stretch.overlap->most.value_or(stretch.overlap->least);
}

std::optional<StretchIndex> stretch_at(const std::vector<FindingGroup>& groups, size_t block) {
    for (size_t group = 0; group < groups.size(); ++group) {
        const auto& all = groups[group].stretches;
        const auto found = std::lower_bound(
            all.begin(), all.end(), block,
            [](const FindingStretch& stretch, size_t wanted) { return stretch.last < wanted; });
        if (found != all.end() && found->first <= block)
            return StretchIndex{group, static_cast<size_t>(found - all.begin())};
    }
    return {};
}

std::optional<StretchIndex> neighbouring_stretch(const std::vector<FindingGroup>& groups,
                                                 const std::optional<StretchIndex>& from,
                                                 bool forward) {
    std::vector<StretchIndex> all;
    for (size_t group = 0; group < groups.size(); ++group)
        for (size_t stretch = 0; stretch < groups[group].stretches.size(); ++stretch)
            all.push_back({group, stretch});
    if (all.empty()) return {};
    const auto here = from ? std::find(all.begin(), all.end(), *from) : all.end();
    if (here == all.end()) return forward ? all.front() : all.back();
    if (forward) return here + 1 == all.end() ? std::nullopt : std::optional(*(here + 1));
    return here == all.begin() ? std::nullopt : std::optional(*(here - 1));
}

namespace {

using Notes = std::vector<FindingNote>;

/// The note on a stretch, or the end of the list.
template <typename NoteList>
auto find_note(NoteList& notes, const std::string& program, const FindingGroup& group,
               const BlockRow& first) {
    const auto distance = [&](const FindingNote& note) {
        return note.line > first.line ? note.line - first.line : first.line - note.line;
    };
    const std::string code = utf8_text(first.text), file = utf8_text(first.file); // as stored
    auto found = notes.end();
    for (auto note = notes.begin(); note != notes.end(); ++note) {
        const bool is_same = note->program == program && note->rule == group.rule
                             && note->pair == group.pair && note->file == file
                             && note->code == code;
        if (is_same && (found == notes.end() || distance(*note) < distance(*found))) found = note;
    }
    return found;
}

FindingNote note_of(const toml::table& table) {
    FindingNote note;
    note.program = table["program"].value_or(std::string());
    note.rule = table["rule"].value_or(std::string());
    note.pair = {table["part"].value_or(std::string()), table["body"].value_or(std::string())};
    note.file = table["file"].value_or(std::string());
    note.line = static_cast<uint32_t>(std::max<int64_t>(table["line"].value_or(int64_t(0)), 0));
    note.code = table["code"].value_or(std::string());
    note.text = table["text"].value_or(std::string());
    return note;
}

} // namespace

std::string note_on(const Notes& notes, const std::string& program, const FindingGroup& group,
                    const BlockRow& first) {
    const auto found = find_note(notes, program, group, first);
    return found == notes.end() ? std::string() : found->text;
}

void write_note(Notes& notes, const std::string& program, const FindingGroup& group,
                const BlockRow& first, const std::string& text) {
    const auto found = find_note(notes, program, group, first);
    if (found != notes.end() && found->line == first.line) notes.erase(found);
    if (!text.empty())
        notes.push_back({program, group.rule, group.pair, utf8_text(first.file), first.line,
                         utf8_text(first.text), text});
}

Notes notes_in(const std::string& text) {
    Notes notes;
    const auto root = parsed_toml(text);
    if (!root) return notes; // as if there were no file
    const toml::array* list = (*root)["note"].as_array();
    if (!list) return notes;
    for (const toml::node& node : *list) {
        if (!node.is_table()) continue;
        FindingNote note = note_of(*node.as_table());
        if (!note.program.empty() && !note.text.empty()) notes.push_back(std::move(note));
    }
    return notes;
}

std::string text_of(const Notes& notes) {
    std::string text = "# Comments on findings, written by feeler view.\n";
    for (const FindingNote& note : notes)
        text += fmt::format(
            "\n[[note]]\nprogram = {}\nrule = {}\npart = {}\nbody = {}\nfile = {}\nline = {}\n"
            "code = {}\ntext = {}\n",
            toml_text(note.program), toml_text(note.rule), toml_text(note.pair[0]),
            toml_text(note.pair[1]), toml_text(note.file), note.line, toml_text(note.code),
            toml_text(note.text));
    return text;
}

Notes merged(Notes stored, const Notes& notes, const std::string& program) {
    std::erase_if(stored, [&](const FindingNote& note) { return note.program == program; });
    std::copy_if(notes.begin(), notes.end(), std::back_inserter(stored),
                 [&](const FindingNote& note) { return note.program == program; });
    return stored;
}

} // namespace app::viewer
