#include "app/viewer/finding_note.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/setup/setup_tables.h"
#include "app/setup/toml_file.h"
#include "app/setup/utf8_text.h"

namespace app::viewer {
namespace {

using Notes = std::vector<FindingNote>;

/// The note on a stretch, or the end.
template <typename NoteList>
auto find_note(NoteList& notes, const std::string& program, const FindingGroup& group,
               const BlockRow& first) {
    const auto distance = [&](const FindingNote& note) {
        return note.line > first.line ? note.line - first.line : first.line - note.line;
    };
    const std::string code = utf8_text(first.text), file = utf8_text(first.file); // as kept
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
    if (!root) return notes; // as if there was no file
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
    std::string text = "# What was written on findings in the window of feeler.\n";
    for (const FindingNote& note : notes)
        text += fmt::format(
            "\n[[note]]\nprogram = {}\nrule = {}\npart = {}\nbody = {}\nfile = {}\nline = {}\n"
            "code = {}\ntext = {}\n",
            toml_text(note.program), toml_text(note.rule), toml_text(note.pair[0]),
            toml_text(note.pair[1]), toml_text(note.file), note.line, toml_text(note.code),
            toml_text(note.text));
    return text;
}

Notes merged(Notes kept, const Notes& notes, const std::string& program) {
    std::erase_if(kept, [&](const FindingNote& note) { return note.program == program; });
    std::copy_if(notes.begin(), notes.end(), std::back_inserter(kept),
                 [&](const FindingNote& note) { return note.program == program; });
    return kept;
}

} // namespace app::viewer
