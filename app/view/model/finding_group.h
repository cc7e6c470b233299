#pragma once

#include <array>
#include <string>
#include <vector>

#include "app/view/model/block_row.h"

namespace app::viewer {

/// Findings of one rule about one pair, in blocks that follow one another but for such that do not
/// move.
struct FindingStretch {
    size_t first = 0, last = 0;      // blocks
    size_t count = 0;                // blocks that have the finding
    size_t worst = 0;                // the block where most is missing
    std::optional<double> clearance; // there, mm; empty where the finding is about none
    double shortfall = 0.0;          // there, mm
    std::string message, cure;       // there
};

/// All findings of one rule about one pair of bodies.
struct FindingGroup {
    std::string rule;
    std::array<std::string, 2> pair; // empty if it is about none
    core::Severity severity = core::Severity::off;
    std::vector<FindingStretch> stretches; // in order; empty if it is about the program as a whole
    size_t worst = 0;                      // of the stretches
    size_t count = 0;                      // blocks
    std::string message, cure;             // of one about the program as a whole
};

/// The findings of a program, grouped: the most severe groups first, then those where most is
/// missing, then in the order of the program.
std::vector<FindingGroup> grouped(const std::vector<BlockRow>& rows,
                                  const std::vector<core::Finding>& findings);

/// A stretch among all groups.
struct StretchPlace {
    size_t group = 0, stretch = 0;

    bool operator==(const StretchPlace&) const = default;
};

/// The first stretch that holds a block.
std::optional<StretchPlace> stretch_at(const std::vector<FindingGroup>& groups, size_t block);

/// The stretch behind or before another one, as they are listed; from the first or last one on
/// without another. Empty at the end of the list.
std::optional<StretchPlace> stretch_beside(const std::vector<FindingGroup>& groups,
                                           const std::optional<StretchPlace>& from, bool forward);

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
