#pragma once

#include <string>
#include <vector>

#include "app/viewer/finding_group.h"

namespace app::viewer {

/// What a person has written on a stretch of findings. It is known again by its rule, its bodies
/// and the text of its first line, also when lines were put in before it.
struct FindingNote {
    std::string program; // path of the file
    std::string rule;
    std::array<std::string, 2> pair;
    std::string file; // of a subprogram
    uint32_t line = 0;
    std::string code; // of that line
    std::string text;

    bool operator==(const FindingNote&) const = default;
};

/// What is written on a stretch; of several lines that read the same, on the nearest one. Empty
/// where nothing is.
std::string note_on(const std::vector<FindingNote>& notes, const std::string& program,
                    const FindingGroup& group, const BlockRow& first);

/// Writes on a stretch in place of what is there; an empty text takes it away.
void write_note(std::vector<FindingNote>& notes, const std::string& program,
                const FindingGroup& group, const BlockRow& first, const std::string& text);

/// The notes in a text; what it says in a wrong way is left out.
std::vector<FindingNote> notes_in(const std::string& text);

std::string text_of(const std::vector<FindingNote>& notes);

/// Notes as they are to be kept: those of a program in place of what was known of it, those of all
/// others as they were, so that two windows do not lose each other's.
std::vector<FindingNote> merged(std::vector<FindingNote> kept,
                                const std::vector<FindingNote>& notes, const std::string& program);

} // namespace app::viewer
